//! All frames in one file: APNG, video, flipbook.

use std::fs::File;
use std::io::{BufReader, Read};
use std::process::{Child, Stdio};

use energywave::RadianceImage;

use crate::animate::{animate, png, scene};
use crate::common::program::{Folder, expect, stderr};

const SMALL: [&str; 3] = ["--frames", "10..13", "-q"];
const PIXELS: usize = 24 * 16;

fn written(more: &str, outputs: &[&[&str]]) -> Folder {
    let folder = Folder::new();
    scene(&folder, "a.toml", more);
    for output in [&[&["f.##.png"][..], &["f.##.exr"]], outputs].concat() {
        let arguments = [&["-o"], output, &SMALL].concat();
        expect(&animate(&folder, &arguments), 0, "");
    }
    folder
}

#[test]
fn an_apng_has_the_frames_one_after_the_other_and_loops_where_the_scene_does() {
    for (more, plays) in [("", 1), ("[time]\nloop = 2\n", 0)] {
        let folder = written(more, &[&["f.apng"]]);
        let file = BufReader::new(File::open(folder.path().join("f.apng")).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let control = *reader.info().animation_control().unwrap();
        assert_eq!((control.num_frames, control.num_plays), (4, plays));
        let mut frames = Vec::new();
        for frame in 10..14 {
            let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut bytes).unwrap();
            let control = reader.info().frame_control().unwrap();
            assert_eq!((control.delay_num, control.delay_den), (1, 30));
            assert_eq!(bytes, png(&folder, &format!("f.{frame}.png")), "{frame}");
            frames.push(bytes);
        }
        assert_ne!(frames[0], frames[3]);
    }
}

#[test]
fn a_video_has_the_frames_in_a_file_and_in_a_pipe() {
    let folder = written("", &[&["f.y4m"]]);
    let video = std::fs::read(folder.path().join("f.y4m")).unwrap();
    let piped = animate(&folder, &[&["-o", "-"], &SMALL[..]].concat());
    assert_eq!(piped.stdout, video);
    let head = b"YUV4MPEG2 W24 H16 F30:1 Ip A1:1 C444 XCOLORRANGE=FULL\n";
    assert!(video.starts_with(head));
    let frames = video[head.len()..].chunks_exact(6 + 3 * PIXELS);
    assert_eq!(frames.len(), 4);
    for (number, frame) in (10..).zip(frames) {
        let planes = frame.strip_prefix(b"FRAME\n").unwrap();
        let picture = png(&folder, &format!("f.{number}.png"));
        // Back to red, green and blue by the inverse of BT.709's matrix; each was rounded once.
        let worst = picture.chunks_exact(3).enumerate().map(|(index, pixel)| {
            let [luma, blue, red] =
                [0, 1, 2].map(|plane| f64::from(planes[plane * PIXELS + index]));
            let (blue, red) = (blue - 128.0, red - 128.0);
            let green = luma - 0.1873 * blue - 0.4681 * red;
            let found = [luma + 1.5748 * red, green, luma + 1.8556 * blue];
            let apart = found
                .iter()
                .zip(pixel)
                .map(|(found, byte)| (found - f64::from(*byte)).abs());
            apart.fold(0.0, f64::max)
        });
        let worst = worst.fold(0.0, f64::max);
        assert!(worst < 2.0, "frame {number} is off by {worst}");
    }
}

/// Starts a video of so many frames that goes to a pipe.
fn piped(folder: &Folder, frames: &str) -> Child {
    let mut command = folder.command();
    let arguments = [
        "animate",
        "a.toml",
        "-o",
        "-",
        "--device",
        "reference",
        "-q",
        "--divisions",
        "2",
        "--frames",
        frames,
    ];
    let command = command
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command.spawn().unwrap()
}

#[test]
fn a_reader_who_leaves_is_told_nothing() {
    let folder = Folder::new();
    scene(&folder, "a.toml", "");
    let mut child = piped(&folder, "0..5000");
    let mut some = [0; 100];
    child.stdout.take().unwrap().read_exact(&mut some).unwrap();
    let output = child.wait_with_output().unwrap();
    expect(&output, 7, "");
    assert_eq!(stderr(&output), "");
}

/// By how much the memory may grow from frame 100 on, KiB, as the allocator takes it: in steps. A frame takes 9.
#[cfg(target_os = "linux")] // resident memory is read from /proc
const GROWN_KIB: i64 = 1024;

#[test]
#[cfg(target_os = "linux")]
fn memory_is_constant_after_a_hundred_frames() {
    let folder = Folder::new();
    scene(&folder, "a.toml", "");
    let mut child = piped(&folder, "0..1000");
    // The pipe holds 64 KiB, so the program is at most some frames ahead of what is read.
    let mut stdout = child.stdout.take().unwrap();
    let mut read = |frames: usize| {
        let mut bytes = vec![0; frames * (6 + 3 * PIXELS)];
        stdout.read_exact(&mut bytes).unwrap();
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
        let line = status.lines().find(|line| line.starts_with("VmRSS:"));
        line.unwrap()
            .split_whitespace()
            .nth(1)
            .unwrap()
            .parse::<i64>()
            .unwrap()
    };
    let (first, hundred, most) = (read(1), read(99), read(300));
    assert!(most - hundred < GROWN_KIB, "{first} {hundred} {most} KiB");
    drop(stdout);
    expect(&child.wait_with_output().unwrap(), 7, "");
}

fn sheet(folder: &Folder) -> serde_json::Value {
    let text = std::fs::read_to_string(folder.path().join("book.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// Returns a frame of a flipbook of 3x2 cells with 2 empty pixels around each, of values of so many channels, and how
/// many values of all cells' margins and of the empty cells are not 0.
fn cut<T: Copy + PartialEq + From<u8>>(
    book: &[T],
    channels: usize,
    cell: usize,
) -> (Vec<T>, usize) {
    let across = 3 * 28;
    assert_eq!(book.len(), across * 2 * 20 * channels);
    let (mut frame, mut margin) = (Vec::new(), 0);
    for (index, pixel) in book.chunks_exact(channels).enumerate() {
        let (column, row) = (index % across, index / across);
        let (inside, of) = ((column % 28, row % 20), column / 28 + 3 * (row / 20));
        if !(2..26).contains(&inside.0) || !(2..18).contains(&inside.1) || of > 3 {
            margin += pixel.iter().filter(|value| **value != T::from(0)).count();
        } else if of == cell {
            frame.extend_from_slice(pixel);
        }
    }
    (frame, margin)
}

#[test]
fn a_flipbook_has_the_frames_in_its_cells_and_a_sheet_beside_it() {
    let flipbook = ["--flipbook", "3x2", "--padding", "2"];
    let book = |name: &'static str| [&[name][..], &flipbook].concat();
    // (what the scene says, blend mode, alpha)
    let cases = [
        ("", "additive", "one"),
        (
            "[display]\nalpha = \"luminance\"\n",
            "premultiplied",
            "premultiplied",
        ),
        ("[display]\nbackground = \"#203040\"\n", "opaque", "one"),
    ];
    for (more, blend_mode, alpha) in cases {
        let folder = written(more, &[&book("book.png"), &book("light.exr")]);
        let has_alpha = alpha == "premultiplied";
        let channels = if has_alpha { 4 } else { 3 };
        let picture = png(&folder, "book.png");
        let light = RadianceImage::open(folder.path().join("light.exr")).unwrap();
        for cell in 0..4 {
            let expected = png(&folder, &format!("f.{}.png", 10 + cell));
            let (found, margin) = cut(&picture, channels, cell);
            assert_eq!(margin, 0);
            match has_alpha {
                false => assert_eq!(found, expected, "{cell}"),
                // The same alpha, and no colour brighter than it; the file of the frame has straight alpha.
                true => {
                    let pairs = || found.chunks_exact(4).zip(expected.chunks_exact(4));
                    assert!(pairs().all(|(one, other)| one[3] == other[3]));
                    assert!(pairs().any(|(one, other)| one[..3] != other[..3]));
                    let opaque = |pixel: &[u8]| pixel[3] == 255;
                    assert!(pairs().all(|(one, other)| !opaque(one) || one == other));
                }
            }
            let file = folder.path().join(format!("f.{}.exr", 10 + cell));
            let expected = RadianceImage::open(file).unwrap();
            let (found, margin) = cut(light.as_slice(), 4, cell);
            assert_eq!((found.as_slice(), margin), (expected.as_slice(), 0));
        }
        let sheet = sheet(&folder);
        let said = |key: &str| sheet[key].as_str().unwrap().to_owned();
        assert_eq!(
            (said("blend_mode"), said("alpha")),
            (blend_mode.to_owned(), alpha.to_owned())
        );
        assert_eq!(
            (said("color_space"), said("image")),
            ("srgb".to_owned(), "book.png".to_owned())
        );
        for (key, value) in [
            ("frames", 4),
            ("first_frame", 10),
            ("columns", 3),
            ("rows", 2),
            ("padding", 2),
            ("width", 84),
            ("height", 40),
            ("frame_width", 24),
        ] {
            assert_eq!(sheet[key], value, "{key}");
        }
        assert_eq!(
            (sheet["fps"].as_f64(), sheet["loop"].as_bool()),
            (Some(30.0), Some(false))
        );
        assert_eq!(sheet["exposure"].as_f64(), Some(0.0));
    }
}

#[test]
fn bounds_hold_all_that_a_screen_shows() {
    let folder = written("", &[&["book.png", "--flipbook", "2x2"]]);
    let bounds = sheet(&folder)["bounds"].clone();
    let [x, y, width, height] =
        ["x", "y", "width", "height"].map(|key| bounds[key].as_u64().unwrap() as usize);
    let (mut least, mut most) = ([24, 16], [0, 0]);
    for frame in 10..14 {
        let light = RadianceImage::open(folder.path().join(format!("f.{frame}.exr"))).unwrap();
        for (index, pixel) in png(&folder, &format!("f.{frame}.png"))
            .chunks_exact(3)
            .enumerate()
        {
            let place = [index % 24, index / 24];
            let is_inside =
                (x..x + width).contains(&place[0]) && (y..y + height).contains(&place[1]);
            assert!(
                is_inside || pixel.iter().all(|value| *value <= 1),
                "{place:?} {pixel:?}"
            );
            if light.as_slice()[4 * index..][..3]
                .iter()
                .any(|light| *light > 0.02)
            {
                for axis in 0..2 {
                    least[axis] = least[axis].min(place[axis]);
                    most[axis] = most[axis].max(place[axis] + 1);
                }
            }
        }
    }
    // They hold what is brighter than a faint light, and are not much larger.
    assert!(x <= least[0] && y <= least[1] && x + width >= most[0] && y + height >= most[1]);
    assert!(width * height < 24 * 16, "{width}x{height}");
}

#[test]
fn additive_light_has_no_alpha_in_a_flipbook_of_any_format() {
    let folder = Folder::new();
    scene(&folder, "a.toml", "[display]\nalpha = \"additive\"\n");
    let frames = animate(&folder, &[&["-o", "f.png"], &SMALL[..]].concat());
    expect(
        &frames,
        3,
        "display.alpha: additive light has colour where alpha is 0",
    );
    let book = animate(
        &folder,
        &[&["-o", "book.png", "--flipbook", "2x2"], &SMALL[..]].concat(),
    );
    expect(&book, 0, "");
    let picture = png(&folder, "book.png");
    let pixels = || picture.chunks_exact(4);
    assert!(pixels().all(|pixel| pixel[3] == 0) && pixels().any(|pixel| pixel[1] > 100));
    let sheet = sheet(&folder);
    assert_eq!(
        (sheet["blend_mode"].as_str(), sheet["alpha"].as_str()),
        (Some("additive"), Some("zero"))
    );
}
