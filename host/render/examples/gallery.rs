//! Draws every kind of scene into a folder (the first argument, else `out/gallery`), and says
//! how long each took.

use std::{path::PathBuf, time::Instant};

use cauldron_fluid::Snapshot;
use cauldron_render::{DEFAULT_THREADS, Handle, Shares, png, render};
use glam::Vec3;

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;
use synthetic::{blended, blobs, boxed, clear, dry, halves, handle, rippled, swirl, view};

/// Each is drawn so often; the quickest counts, for others may be using the machine.
const ATTEMPTS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("out/gallery".to_owned()));
    std::fs::create_dir_all(&folder)?;
    for (name, snapshot, handle) in scenes() {
        let (mut image, mut render_ms) = (None, f64::INFINITY);
        for _ in 0..ATTEMPTS {
            let start = Instant::now();
            image = Some(render(&view(&snapshot, handle), 480, 360, DEFAULT_THREADS));
            render_ms = render_ms.min(start.elapsed().as_secs_f64() * 1e3);
        }
        let Some(image) = image else { continue };
        let canvas = image.resolve();
        png::write(folder.join(format!("{name}.png")), &canvas)?;
        println!("{name:14} {render_ms:6.1} ms  {:?}", Shares::of(&canvas));
    }
    Ok(())
}

fn scenes() -> Vec<(&'static str, Snapshot, Option<Handle>)> {
    let dipped = Vec3::new(0.03, -0.02, 0.02);
    let under = Vec3::new(-0.02, -0.10, 0.03);
    vec![
        ("clear", clear(), None),
        ("blobs", blobs(), Some(handle(dipped, 0.05))),
        ("halves", halves(), None),
        ("swirl", rippled(swirl()), Some(handle(under, 0.3))),
        ("blended", rippled(blended(0.4)), Some(handle(dipped, 0.8))),
        ("thin", blended(0.03), None),
        ("rippled", rippled(clear()), Some(handle(under, 0.0))),
        ("box", rippled(boxed(blobs())), Some(handle(dipped, 0.3))),
        ("dry", dry(), Some(handle(under, 0.9))),
    ]
}
