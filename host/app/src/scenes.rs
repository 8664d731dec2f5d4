//! `cauldron scenes`.

use cauldron_fluid::scenes::INDEX;
use serde::Serialize;
use std::io::{self, Write};

use crate::{Failure, cli::ScenesArgs};

#[derive(Serialize)]
struct Row {
    scene: &'static str,
    about: &'static str,
    grid: [usize; 3],
    substances: usize,
    surface: bool,
}

/// Lists the scenes.
///
/// # Errors
/// [`Failure::Input`] if stdout is closed.
pub fn list(args: &ScenesArgs) -> Result<(), Failure> {
    let mut text = String::new();
    for row in INDEX {
        let scene = (row.make)();
        let [nx, ny, nz] = scene.grid.cells;
        if args.json {
            let row = Row {
                scene: row.name,
                about: row.about,
                grid: scene.grid.cells,
                substances: scene.substances.len(),
                surface: scene.surface.is_some(),
            };
            text += &(serde_json::to_string(&row).unwrap_or_default() + "\n");
        } else {
            text += &format!("{:<14} {} ({nx} x {ny} x {nz} cells)\n", row.name, row.about);
        }
    }
    io::stdout()
        .write_all(text.as_bytes())
        .map_err(|e| Failure::Input(format!("cannot write to stdout: {e}")))
}
