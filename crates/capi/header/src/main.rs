//! Makes `include/energywave.h` of the source of `crates/capi`; with `--check` it says whether the header is stale.
//!
//! `cargo run -p energywave-capi-header [-- --check]`

use std::error::Error;
use std::fs;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let header = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = header.parent().ok_or("no folder above this one")?;
    let path = root.join("include/energywave.h");
    let made = made(root)?;
    if std::env::args().nth(1).as_deref() != Some("--check") {
        return Ok(fs::write(path, made)?);
    }
    let there = fs::read_to_string(&path)?;
    if made == there {
        return Ok(());
    }
    let mut lines = made.lines().zip(there.lines());
    let first = lines.find(|(made, there)| made != there);
    let (made, there) = first.unwrap_or(("", "other lines at its end"));
    Err(format!(
        "{} is stale: it has\n    {there}\nwhere the source says\n    {made}\nmake it anew: cargo run -p \
         energywave-capi-header",
        path.display()
    )
    .into())
}

fn made(root: &Path) -> Result<String, Box<dyn Error>> {
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml"))?;
    let bindings = cbindgen::generate_with_config(root, config)?;
    let mut text = Vec::new();
    bindings.write(&mut text);
    Ok(String::from_utf8(text)?)
}
