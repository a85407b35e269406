//! What users run and read: the program, its scene files, the examples.
#![allow(clippy::unwrap_used, clippy::panic)] // tests fail by panicking

#[path = "../common/mod.rs"]
mod common;

#[cfg(unix)] // as cli
mod animate; // draws frames of scenes that move
#[cfg(unix)] // as animate
mod bad_animations; // has frames refused that cannot be
mod bad_displays; // has displays refused that no file can hold
mod bad_looks; // has every fault of layers named with its place
#[cfg(unix)] // as cli
mod bad_metaballs; // has every fault of surfaces and particles named
mod bad_particles; // refuses bad particles, with their place
mod bad_points; // refuses bad points of light, with their place
mod bad_scenes;
mod bad_series; // has every fault of a scene file named with its place
mod bad_simulations; // has every fault of waves of particles named with its place
mod bad_tracks;
#[cfg(unix)] // as cli
mod bake; // samples scenes on grids, and has other programs read them
mod bench; // compares the speed tables' frames with float64, and reads what `energywave bench` says
mod cameras; // reads matrices of engines, and refuses what is none
#[cfg(unix)] // shells, signals and the loader's environment variables
mod cli; // runs the program: exit codes, messages and outputs
mod clip_depths; // reads depth files of engines
mod compares; // maps errors, and reads measurements as data
mod damaged; // changes bytes of images and scenes
#[cfg(unix)] // as cli
mod depths; // reads depth images of other programs
mod displays; // lays files over plates as other programs do
mod errors; // tells errors apart by their codes, and refuses wrong options
mod examples; // runs every example
mod export; // draws shaders by OpenGL, beside the reference
mod export_scenes; // scenes for that
mod export_values; // asks for blocks, refusals and texts for other hosts
mod figures; // draws the papers' figures
mod groups; // has groups placed as the sources that they stand for
#[cfg(unix)] // as cli
mod help;
mod light_groups; // reads what the program says of itself, and types its examples
mod lighting; // reads how meshes are lit, and has every fault named with its place
mod meshes; // reads meshes from files, and has every fault named with its place
mod messages; // is told what to write instead, and nothing raw or long
#[cfg(unix)] // as cli
mod metaballs; // reads surfaces and particles, and writes them
mod methods; // chooses ways to integrate, in files and by options
#[cfg(unix)] // as cli
mod outputs; // writes to links, pipes and devices, and reads scenes from pipes
#[cfg(unix)] // as cli
mod presets; // writes every preset, and nothing over what is there
mod scene_files; // reads again what was written
mod simulation; // has waves of particles hit things
mod speaks; // says what it drew, and is quiet
mod tracks; // draws scenes at times
mod vdb_volumes; // reads volumes of OpenVDB, and refuses damaged ones
mod verify; // checks known rays, past sources and past whole scenes
#[cfg(unix)] // as animate, whose scene they draw
mod videos; // lays all frames into one file
mod volumes; // reads volumes, and refuses what is none
mod warnings; // is told what a scene was hardly meant to say
#[cfg(unix)] // as cli
mod watch; // draws scenes again that are saved
