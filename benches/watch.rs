//! From the saving of a scene to the whole picture of it: `energywave watch` at 512x512, PNG and EXR, edited as editors
//! do. `cargo bench --bench watch`.
#![allow(clippy::unwrap_used, clippy::panic)] // a bench fails by panicking

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

/// Edits that are measured, after some that are not.
const EDITS: usize = 40;
const WARM: usize = 5;

fn main() {
    let program = env!("CARGO_BIN_EXE_energywave");
    let presets = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/presets");
    println!(
        "from a save to its picture, 512x512, milliseconds: median, quickest, slowest of {EDITS}"
    );
    for preset in ["laser", "kamehameha", "nova"] {
        let text = fs::read_to_string(presets.join(format!("{preset}.toml"))).unwrap();
        for ending in ["png", "exr"] {
            let folder = tempfile::tempdir().unwrap();
            let file = |name: &str| folder.path().join(name);
            fs::write(file("a.toml"), &text).unwrap();
            let output = file(&format!("out.{ending}"));
            let mut watch = Command::new(program)
                .args(["watch", "--size", "512x512", "-o"])
                .arg(&output)
                .arg(file("a.toml"))
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            let mut last = wait(&output, None);
            let mut times = Vec::new();
            for edit in 0..WARM + EDITS {
                // An editor's user takes longer.
                std::thread::sleep(Duration::from_millis(100));
                fs::write(file("new~"), format!("{text}\n# {edit}\n")).unwrap();
                let begun = Instant::now();
                fs::rename(file("new~"), file("a.toml")).unwrap();
                last = wait(&output, Some(last));
                times.push(begun.elapsed().as_secs_f64() * 1e3);
            }
            watch.kill().unwrap();
            watch.wait().unwrap();
            let times = &mut times[WARM..];
            times.sort_by(f64::total_cmp);
            let (least, middle, most) = (times[0], times[EDITS / 2], times[EDITS - 1]);
            println!("{preset:>12} {ending}: {middle:6.1} {least:6.1} {most:6.1}");
        }
    }
}

/// Waits until a file is there that was written after another time; returns when.
fn wait(file: &Path, after: Option<SystemTime>) -> SystemTime {
    let end = Instant::now() + Duration::from_secs(600);
    loop {
        let written = fs::metadata(file).and_then(|data| data.modified()).ok();
        if let Some(written) = written.filter(|time| after.is_none_or(|after| *time > after)) {
            return written;
        }
        assert!(Instant::now() < end, "no picture");
        std::thread::sleep(Duration::from_micros(500));
    }
}
