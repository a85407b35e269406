//! Writes the programs of the wave as a driver's compiler gets them, for compilers that run without a device:
//! `cargo run --example kernel_text -- FOLDER tiles-torus render-curve-squares ...`
//!
//! Each name is a kernel (`tiles`, `render`, `trace`, or `simpson`, every pixel by that rule), then kinds of source or
//! `all`, then what else it has: `squares`, `series`, `depths`. `FOLDER/NAME.cl` is the text, `FOLDER/NAME.options` the
//! compiler's options; as for a GPU, one ray a work-item and 16 work-items a tile, at a tolerance of 1e-3.
use std::path::Path;
use std::process::ExitCode;

use energywave::internals::{KINDS, ProgramTask, program_text};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((folder, names)) = arguments.split_first() else {
        eprintln!(
            "no folder; say where the texts go, and which: FOLDER tiles-torus render-all-squares"
        );
        return ExitCode::FAILURE;
    };
    for name in names {
        if let Err(message) = write(Path::new(folder), name) {
            eprintln!("{name}: {message}");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

fn write(folder: &Path, name: &str) -> Result<(), String> {
    let mut words = name.split('-');
    let kernel = words.next().unwrap_or_default();
    if !["tiles", "render", "trace", "simpson"].contains(&kernel) {
        return Err(format!(
            "\"{kernel}\" is no kernel; tiles, render, trace or simpson"
        ));
    }
    let mut kinds = Vec::new();
    let (mut has_squares, mut has_shapes) = (false, false);
    let (mut fading, mut has_convolutions) = (None, false);
    let (mut has_series, mut has_depth) = (false, false);
    for word in words {
        match word {
            "all" => kinds.extend(KINDS),
            "squares" => has_squares = true,
            "shapes" => has_shapes = true,
            "absorption" => fading = Some(2),
            "convolution" => has_convolutions = true,
            "series" => has_series = true,
            "depths" => has_depth = true,
            kind if KINDS.contains(&kind) => kinds.push(kind),
            other => {
                let right = KINDS.join(", ");
                return Err(format!(
                    "\"{other}\" is no kind; {right}, all, squares, shapes, absorption, convolution, series or depths"
                ));
            }
        }
    }
    let (text, options) = program_text(&ProgramTask {
        kernel,
        kinds: &kinds,
        tolerance: (kernel != "simpson").then_some(1e-3),
        has_squares,
        has_shapes,
        has_convolutions,
        fading,
        has_series,
        has_depth,
        lanes: 1,
        workers: 16,
    });
    let write = |ending: &str, content: String| {
        let file = folder.join(format!("{name}.{ending}"));
        std::fs::write(&file, content).map_err(|error| format!("{}: {error}", file.display()))
    };
    write("cl", text)?;
    write("options", options)
}
