//! A scene that is drawn again whenever it is saved.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use energywave::{Device, RadianceImage, Renderer, Scene};

use crate::common::program::{Folder, expect};

/// Longer than any machine takes to draw a few pixels.
const PATIENCE: Duration = Duration::from_secs(120);

fn text(radius: f64, more: &str) -> String {
    format!(
        "[camera]\neye = [0, -4, 1]\ntarget = [0, 0, 0]\n[image]\nwidth = 6\nheight = 4\n{more}[[sphere]]\n\
         radius = {radius}\n"
    )
}

/// A program that watches, and what it says.
struct Watch {
    folder: Folder,
    child: Child,
    said: Receiver<String>,
}

impl Watch {
    fn of(scene: &str, arguments: &[&str]) -> Self {
        let folder = Folder::new();
        fs::write(folder.path().join("a.toml"), scene).unwrap();
        let mut child = folder
            .command()
            .args(["watch", "a.toml", "-o", "out.exr", "--device", "reference"])
            .args(arguments)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let (sender, said) = channel();
        thread::spawn(move || {
            lines
                .map_while(Result::ok)
                .try_for_each(|line| sender.send(line))
        });
        Self {
            folder,
            child,
            said,
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Waits until a line is said.
    #[track_caller]
    fn hear(&self, words: &str) -> String {
        let end = Instant::now() + PATIENCE;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let line = self.said.recv_timeout(left).unwrap();
            if line.contains(words) {
                return line;
            }
        }
    }

    /// Saves as editors do: a new file in the place of the old one.
    fn save(&self, name: &str, data: impl AsRef<[u8]>) {
        fs::write(self.path("new~"), data).unwrap();
        fs::rename(self.path("new~"), self.path(name)).unwrap();
    }

    fn picture(&self) -> RadianceImage {
        RadianceImage::open(self.path("out.exr")).unwrap()
    }

    /// Waits for a picture, which is that of the scene as it is now.
    #[track_caller]
    fn expect_drawn(&self) -> RadianceImage {
        self.hear("drawn: ");
        let scene = Scene::from_file(self.path("a.toml")).unwrap();
        let mut renderer = Renderer::new(&Device::reference()).unwrap();
        let picture = self.picture();
        assert_eq!(picture, renderer.render(&scene).unwrap());
        picture
    }

    /// Ends it as Ctrl-C does.
    fn end(&mut self) {
        let id = self.child.id().to_string();
        Command::new("kill").args(["-INT", &id]).status().unwrap();
        assert!(self.child.wait().unwrap().success());
        let names = self.folder.names();
        assert!(names.iter().all(|name| !name.starts_with('.')), "{names:?}");
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.child.kill();
    }
}

#[test]
fn a_saved_change_is_drawn_and_a_fault_leaves_the_last_picture() {
    let mut watch = Watch::of(&text(0.1, ""), &[]);
    let first = watch.expect_drawn();
    watch.save("a.toml", text(0.2, ""));
    let second = watch.expect_drawn();
    assert_ne!(first, second);
    // Written in place, too.
    fs::write(watch.path("a.toml"), text(0.3, "")).unwrap();
    let third = watch.expect_drawn();
    assert_ne!(second, third);
    watch.save("a.toml", text(-1.0, ""));
    let fault = watch.hear("error: ");
    let words = "error: a.toml:8:10: sphere[0].radius: a thickness is positive";
    assert!(fault.starts_with(words), "{fault}");
    assert_eq!(watch.picture(), third);
    watch.save("a.toml", "[camera\n");
    assert!(watch.hear("error: ").contains("a.toml:1:"));
    assert_eq!(watch.picture(), third);
    fs::remove_file(watch.path("a.toml")).unwrap();
    watch.hear("error: a.toml: cannot read");
    watch.save("a.toml", text(0.2, ""));
    assert_eq!(watch.expect_drawn(), second);
    watch.end();
}

#[test]
fn files_that_a_scene_names_are_watched_as_soon_as_it_names_them() {
    let depths = |depth: f32| {
        let bytes = [depth; 24].map(f32::to_le_bytes);
        bytes.as_flattened().to_vec()
    };
    let mut watch = Watch::of(&text(0.1, ""), &[]);
    let first = watch.expect_drawn();
    fs::create_dir(watch.path("depths")).unwrap();
    fs::write(watch.path("depths/near.f32"), depths(4.0)).unwrap();
    watch.save("a.toml", text(0.1, "[depth]\nfile = \"depths/near.f32\"\n"));
    let hidden = watch.expect_drawn();
    assert_ne!(hidden, first);
    watch.save("depths/near.f32", depths(5.0));
    let further = watch.expect_drawn();
    assert_ne!(further, hidden);
    watch.save("depths/near.f32", [0; 7]);
    assert!(watch.hear("error: ").contains("depth.file"));
    assert_eq!(watch.picture(), further);
    // What is read or written beside them is no change.
    fs::write(watch.path("other.toml"), "").unwrap();
    fs::read(watch.path("a.toml")).unwrap();
    watch.save("depths/near.f32", depths(4.0));
    assert_eq!(watch.expect_drawn(), hidden);
    assert!(watch.said.try_recv().is_err());
    watch.end();
}

#[test]
fn files_of_particles_are_watched_as_depths_are() {
    let dot = |height: f64| format!("# x y z\n0, 0, {height}\n");
    for table in [
        "[[particles]]\nradius = 1.5\n",
        "[[metaballs]]\nradius = 3\nthreshold = 0.25\n",
    ] {
        let named = format!("{table}file = \"points/dots.csv\"\n");
        let mut watch = Watch::of(&text(0.1, ""), &[]);
        let first = watch.expect_drawn();
        fs::create_dir(watch.path("points")).unwrap();
        fs::write(watch.path("points/dots.csv"), dot(0.0)).unwrap();
        watch.save("a.toml", text(0.1, &named));
        let low = watch.expect_drawn();
        assert_ne!(low, first, "{table}");
        watch.save("points/dots.csv", dot(0.4));
        let high = watch.expect_drawn();
        assert_ne!(high, low, "{table}");
        watch.save("points/dots.csv", "0, 0\n");
        let fault = watch.hear("error: ");
        assert!(fault.contains("].file"), "{fault}");
        assert_eq!(watch.picture(), high, "{table}");
        watch.save("points/dots.csv", dot(0.0));
        assert_eq!(watch.expect_drawn(), low, "{table}");
        watch.end();
    }
}

#[test]
fn slices_that_are_painted_or_added_are_drawn() {
    let mut watch = Watch::of(&text(0.1, ""), &[]);
    let first = watch.expect_drawn();
    fs::create_dir(watch.path("slices")).unwrap();
    let paint = |gray: u8| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let picture = image::RgbaImage::from_pixel(2, 2, image::Rgba([gray, gray, gray, 255]));
        picture
            .write_to(&mut bytes, image::ImageFormat::Png)
            .unwrap();
        bytes.into_inner()
    };
    watch.save("slices/a.png", paint(100));
    watch.save("slices/b.png", paint(100));
    watch.save(
        "a.toml",
        text(0.1, "[[volume]]\nslices = \"slices/*.png\"\n"),
    );
    let pale = watch.expect_drawn();
    assert_ne!(pale, first);
    watch.save("slices/b.png", paint(250));
    let painted = watch.expect_drawn();
    assert_ne!(painted, pale);
    watch.save("slices/c.png", paint(20));
    assert_ne!(watch.expect_drawn(), painted);
    watch.save("slices/b.png", "none");
    assert!(watch.hear("error: ").contains("].slices"));
    watch.end();
    let folder = Folder::new();
    let scene = text(0.1, "[[volume]]\nslices = \"*.png\"\n");
    fs::write(folder.path().join("a.toml"), scene).unwrap();
    let output = folder.run(&["watch", "a.toml", "-o", "out.png", "--device", "reference"]);
    expect(&output, 7, "it is a file that is watched");
}

#[test]
fn a_time_and_overrides_hold_for_every_picture() {
    let moving = "{ times = [0, 2], values = [0.1, 0.5] }";
    let scene = |coefficient: f64| {
        let text = text(0.1, "[time]\nshutter = 0.5\n");
        format!("{text}coefficient = {coefficient}\n").replace("0.1", moving)
    };
    let mut watch = Watch::of(&scene(1.0), &["--time", "1", "--size", "5x3"]);
    for coefficient in [1.0, 2.0] {
        watch.save("a.toml", scene(coefficient));
        watch.hear("drawn: 5x3 pixels in");
        let still = scene(coefficient).replace(moving, "0.3");
        let mut still = Scene::from_toml(&still).unwrap();
        (still.image.width, still.image.height) = (5, 3);
        let mut renderer = Renderer::new(&Device::reference()).unwrap();
        // Of a scene that is saved before it is read, one picture is enough.
        let end = Instant::now() + PATIENCE;
        while watch.picture() != renderer.render(&still).unwrap() {
            assert!(Instant::now() < end, "{coefficient}");
            thread::sleep(Duration::from_millis(5));
        }
    }
    watch.end();
    let mut blurred = Watch::of(&scene(1.0), &["--fps", "1"]);
    blurred.hear(", the mean of ");
    blurred.end();
}

#[test]
fn what_cannot_be_watched_is_refused() {
    let folder = Folder::new();
    let name = |file: &str| folder.path().join(file);
    fs::write(
        name("a.toml"),
        text(0.1, "[display]\nbackground = \"b.png\"\n"),
    )
    .unwrap();
    fs::write(name("b.png"), "none").unwrap();
    let device = ["--device", "reference"];
    let watch = |arguments: &[&str]| folder.run(&[&["watch"], arguments, &device].concat());
    expect(
        &watch(&["b.toml", "-o", "out.png"]),
        3,
        "b.toml: cannot read",
    );
    expect(&watch(&[".", "-o", "out.png"]), 3, ".: cannot read");
    expect(&watch(&["a.toml", "-o", "-"]), 2, "unknown output ending");
    expect(
        &watch(&["-", "-o", "out.png"]),
        2,
        "standard input is never saved again",
    );
    expect(&watch(&["a.toml", "-o", "out.gif"]), 2, "gif");
    expect(
        &watch(&["a.toml", "-o", "b.png"]),
        7,
        "it is a file that is watched",
    );
    expect(&watch(&["a.toml", "-o", "no/out.png"]), 7, "no");
    // Without windows, or without a display.
    let mut command = folder.command();
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    let output = command.args(["watch", "a.toml"]).output().unwrap();
    expect(&output, 2, "name an image to write: -o FILE");
    assert_eq!(fs::read(name("b.png")).unwrap(), b"none");
    assert_eq!(folder.names().len(), 2);
}
