//! `cauldron scenes`.

use cauldron_fluid::{
    Pot,
    plan::Item,
    scenes::{self, INDEX, Scene},
};
use serde::Serialize;
use std::io::{self, Write};

use crate::{Failure, cli::ScenesArgs, grid, world::Options};

#[derive(Serialize)]
struct Row<'a> {
    scene: &'a str,
    about: &'a str,
    grid: [usize; 3],
    substances: usize,
    surface: bool,
}

/// One thing that a scene may compute.
#[derive(Serialize)]
struct Planned<'a> {
    scene: &'a str,
    grid: [usize; 3],
    part: &'a str,
    how: Option<&'a str>,
    bytes: usize,
    bytes_per_cell: f64,
}

/// Lists the scenes, or says what one of them computes.
///
/// # Errors
/// [`Failure::Input`] if there is no such scene, or stdout is closed.
pub fn list(args: &ScenesArgs) -> Result<(), Failure> {
    let one = |name: &String| scenes::find(name).map_err(|e| Failure::Input(e.to_string()));
    let listed = match &args.scene {
        Some(name) => vec![one(name)?],
        None => INDEX.iter().map(|row| (row.make)()).collect(),
    };
    let mut text = String::new();
    for scene in listed {
        text += &if args.plan { plan(scene, args)? } else { line(&scene, args.json) };
    }
    io::stdout()
        .write_all(text.as_bytes())
        .map_err(|e| Failure::Input(format!("cannot write to stdout: {e}")))
}

fn line(scene: &Scene, is_json: bool) -> String {
    let [nx, ny, nz] = scene.grid.cells;
    if !is_json {
        return format!("{:<14} {} ({nx} x {ny} x {nz} cells)\n", scene.name, scene.about);
    }
    let row = Row {
        scene: &scene.name,
        about: &scene.about,
        grid: scene.grid.cells,
        substances: scene.substances.len(),
        surface: scene.surface.is_some(),
    };
    serde_json::to_string(&row).unwrap_or_default() + "\n"
}

fn plan(mut scene: Scene, args: &ScenesArgs) -> Result<String, Failure> {
    let options = Options::new(1);
    if let Some(choice) = args.grid {
        grid::cut(&mut scene, choice, &options)?;
    }
    let pot = Pot::new(&scene, options.pool, options.simd)
        .map_err(|wrong| Failure::Input(wrong.to_string()))?;
    let (items, cells) = (pot.plan(), scene.grid.len());
    if args.json {
        return Ok(items.iter().map(|item| planned(&scene, item, cells)).collect());
    }
    let [nx, ny, nz] = scene.grid.cells;
    let mut text = format!("{}, {nx} x {ny} x {nz} cells\n", scene.name);
    for item in &items {
        let (how, bytes) = (item.how.as_deref().unwrap_or("-"), item.bytes as f64 / cells as f64);
        text += &format!("  {:<20} {how:<70} {bytes:>6.1} B/cell\n", item.name);
    }
    let total: usize = items.iter().map(|item| item.bytes).sum();
    let (per_cell, mib) = (total as f64 / cells as f64, total as f64 / f64::from(1 << 20));
    text += &format!("  {:<20} {:<70} {per_cell:>6.1} B/cell, {mib:.1} MiB\n", "together", "");
    Ok(text)
}

fn planned(scene: &Scene, item: &Item, cells: usize) -> String {
    let row = Planned {
        scene: &scene.name,
        grid: scene.grid.cells,
        part: item.name,
        how: item.how.as_deref(),
        bytes: item.bytes,
        bytes_per_cell: item.bytes as f64 / cells as f64,
    };
    serde_json::to_string(&row).unwrap_or_default() + "\n"
}
