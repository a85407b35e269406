//! What a format cannot hold, and what is no display, is refused with its place, and nothing is written.

use crate::common::program::{Folder, expect};
use crate::displays::{plate, save, scene};
use energywave::image::{Display, ImageFormat};

/// Keys, the output, what was typed, the exit code, and what is said.
const BAD: &[(&str, &str, &[&str], i32, &str)] = &[
    (
        "alpha = \"additive\"",
        "x.png",
        &[],
        3,
        "16:9: display.alpha: additive light has colour where alpha is 0",
    ),
    (
        "alpha = \"additive\"",
        "x.webp",
        &[],
        3,
        "which the straight alpha of WebP cannot say",
    ),
    (
        "alpha = \"luminance\"",
        "x.jpg",
        &[],
        3,
        "16:9: display.alpha: JPEG has no alpha; write an .exr or .png",
    ),
    (
        "alpha = \"none\"",
        "x.png",
        &[],
        3,
        "16:9: display.alpha: unknown variant `none`, expected one of `opaque`",
    ),
    (
        "background = \"none.png\"",
        "x.png",
        &[],
        3,
        "16:14: display.background: ",
    ),
    (
        "background = \"scene.toml\"",
        "x.png",
        &[],
        3,
        "neither .exr nor a PNG that can be read",
    ),
    (
        "background = \"#12345\"",
        "x.png",
        &[],
        3,
        "16:14: display.background: a colour is three numbers",
    ),
    (
        "background = [0, 0, 2]",
        "x.png",
        &[],
        3,
        "16:14: display.background: channels lie between 0 and 1",
    ),
    (
        "background = 1",
        "x.png",
        &[],
        3,
        "expected a colour such as",
    ),
    (
        "background = \"plate.png\"",
        "x.png",
        &["--size", "41x24"],
        3,
        "the background has 40x24 pixels, the image 41x24",
    ),
    (
        "bits = 12",
        "x.png",
        &[],
        3,
        "16:8: display.bits: 12 bits a channel; a PNG has 8 or 16, an EXR 16 or 32",
    ),
    (
        "bits = 32",
        "x.png",
        &[],
        3,
        "16:8: display.bits: 32 bits a channel; PNG has 8 or 16",
    ),
    (
        "bits = 8",
        "x.exr",
        &[],
        3,
        "16:8: display.bits: 8 bits a channel; EXR has 16 or 32",
    ),
    (
        "bits = 16",
        "x.webp",
        &[],
        3,
        "16:8: display.bits: 16 bits a channel; WebP has 8",
    ),
    (
        "bits = 16.5",
        "x.png",
        &[],
        3,
        "16:8: display.bits: invalid type: number `16.5`, expected a whole number",
    ),
    (
        "quality = 0",
        "x.jpg",
        &[],
        3,
        "16:11: display.quality: 0; a quality lies between 1 and 100",
    ),
    (
        "bloom = { strength = 1.5 }",
        "x.png",
        &[],
        3,
        "16:22: display.bloom.strength: 1.5; the share of light that is spread lies between 0 and 1",
    ),
    (
        "bloom = { strength = 0.5, radius = 0 }",
        "x.exr",
        &[],
        3,
        "16:36: display.bloom.radius: 0; it is a share of the image's height, above 0",
    ),
    (
        "bloom = { radius = 0.1 }",
        "x.png",
        &[],
        3,
        "16:9: display.bloom.strength: required, but missing",
    ),
    (
        "bloom = 0.2",
        "x.png",
        &[],
        3,
        "16:9: display.bloom: invalid type: number `0.2`, expected the table of Bloom",
    ),
    (
        "bloom = { strenght = 0.2 }",
        "x.png",
        &[],
        3,
        "did you mean `strength`?",
    ),
    (
        "exposure = \"automatic\"",
        "x.png",
        &[],
        3,
        "expected a number of stops, or \"auto\"",
    ),
    (
        "exposure = \"0,5\"",
        "x.png",
        &[],
        3,
        "or \"auto\"; write 0.5",
    ),
    (
        "",
        "x.png",
        &["--bits", "32"],
        2,
        "--bits: 32 bits a channel; PNG has 8 or 16",
    ),
    (
        "",
        "x.png",
        &["--exposure", "bright"],
        2,
        "a number of stops from -100 to 100, or auto",
    ),
    (
        "",
        "x.png",
        &["--exposure", "101"],
        2,
        "a number of stops from -100 to 100, or auto",
    ),
    ("", "x.gif", &[], 2, "also .webp and .jpg"),
];

#[test]
fn what_a_format_cannot_hold_and_what_is_no_background_are_refused_with_their_place() {
    let folder = Folder::new();
    plate(&folder);
    for (display, output, more, code, words) in BAD {
        save(&folder, "scene.toml", &scene(display));
        let small = [
            "render",
            "scene.toml",
            "-o",
            output,
            "--device",
            "reference",
        ];
        let found = folder.run(&[&small[..], more].concat());
        expect(&found, *code, words);
        assert!(!folder.path().join(output).exists(), "{display}");
    }
    // Over a background additive light is opaque.
    save(
        &folder,
        "scene.toml",
        &scene("alpha = \"additive\"\nbackground = \"#102030\""),
    );
    expect(
        &folder.run(&[
            "render",
            "scene.toml",
            "-o",
            "x.jpg",
            "--device",
            "reference",
        ]),
        0,
        "",
    );
    assert!(ImageFormat::Png.check(&Display::default()).is_ok());
}
