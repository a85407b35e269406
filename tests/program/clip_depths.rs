//! Depth files of engines: 16-bit PNG, float32 without a header, half floats and whole numbers in OpenEXR, and depths
//! of clip space.

use energywave::Scene;
use energywave::image::DepthAlong;
use exr::image::{AnyChannel, FlatSamples, Layer};
use exr::prelude::{AnyChannels, Encoding, Image, LayerAttributes, WritableImage, f16};
use std::path::Path;

/// Reversed z, the far plane infinitely far, the near plane at 0.1: a depth is 0.1 over the distance.
const CAMERA: &str = "[camera]\nview = [1,0,0,0, 0,0,1,0, 0,-1,0,-4, 0,0,0,1]\n\
    projection = [1,0,0,0, 0,1,0,0, 0,0,0,0.1, 0,0,-1,0]\n[image]\nwidth = 2\nheight = 1\n";
const LOOKS: &str =
    "[camera]\neye = [0, -4, 0]\ntarget = [0, 0, 0]\n[image]\nwidth = 2\nheight = 1\n";

/// Reads a scene in a folder: its depths, or what is wrong.
fn depths(folder: &Path, camera: &str, keys: &str) -> Result<Vec<f32>, String> {
    let path = folder.join("scene.toml");
    std::fs::write(&path, format!("{camera}[depth]\n{keys}")).unwrap();
    let scene = Scene::from_file(&path).map_err(|error| error.to_string())?;
    // What is written is read again.
    let again = folder.join("again.toml");
    scene.save(&again).unwrap();
    assert_eq!(Scene::from_file(&again).unwrap(), scene);
    let depth = scene.depth.unwrap();
    let is_length = keys.contains("axis") || !keys.contains("along");
    assert!(is_length || depth.along() == DepthAlong::Axis);
    Ok(depth.as_slice().to_vec())
}

fn write_exr(path: &Path, samples: FlatSamples) {
    let channels = AnyChannels::sort([AnyChannel::new("Z", samples)].into_iter().collect());
    let attributes = LayerAttributes::default();
    let layer = Layer::new((2, 1), attributes, Encoding::UNCOMPRESSED, channels);
    Image::from_layer(layer).write().to_file(path).unwrap();
}

#[test]
fn every_form_of_file_holds_depths_of_clip_space() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let at = |name: &str| folder.join(name);
    let png = |values: &[u16]| {
        let image = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(2, 1, values.to_vec());
        image.unwrap().save(at("d.png")).unwrap();
    };
    png(&[13107, 0]); // a fifth
    std::fs::write(at("d.f32"), [0.2_f32, 0.0].map(f32::to_le_bytes).concat()).unwrap();
    write_exr(
        &at("half.exr"),
        FlatSamples::F16([0.2, 0.0].map(f16::from_f32).to_vec()),
    );
    write_exr(&at("uint.exr"), FlatSamples::U32(vec![13107, 0]));
    for (file, scale, off) in [
        ("d.png", 1.0, 1e-6),
        ("d.f32", 1.0, 1e-6),
        ("half.exr", 1.0, 1e-3),
        ("uint.exr", 1.0 / 65535.0, 1e-6),
    ] {
        for along in ["ndc", "buffer"] {
            let keys = format!("file = \"{file}\"\nalong = \"{along}\"\nscale = {scale}\n");
            let found = depths(folder, CAMERA, &keys).unwrap();
            assert!(
                (found[0] - 0.5).abs() < off && found[1] == f32::INFINITY,
                "{file}: {found:?}"
            );
        }
    }
    // A buffer of OpenGL's, by a projection of the depth's own: near 1, far 9.
    let gl = "projection = [1,0,0,0, 0,1,0,0, 0,0,-1.25,-2.25, 0,0,-1,0]\nrange = \"-1..1\"\n";
    std::fs::write(at("gl.raw"), [0.5_f32, 1.0].map(f32::to_le_bytes).concat()).unwrap();
    let keys = format!("file = \"gl.raw\"\nalong = \"buffer\"\n{gl}");
    assert_eq!(depths(folder, LOOKS, &keys).unwrap(), [1.8, f32::INFINITY]);
    // Lengths: white is one unit.
    let lengths = depths(folder, LOOKS, "file = \"d.png\"\nscale = 10\nnone = 0\n").unwrap();
    assert_eq!(lengths, [2.0, f32::INFINITY]);
}

#[test]
fn what_cannot_be_read_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let at = |name: &str| folder.join(name);
    std::fs::write(at("short.raw"), [0; 12]).unwrap();
    std::fs::write(at("d.raw"), [3.0_f32, 0.0].map(f32::to_le_bytes).concat()).unwrap();
    std::fs::write(
        at("minus.raw"),
        [-0.5_f32, 0.0].map(f32::to_le_bytes).concat(),
    )
    .unwrap();
    image::RgbImage::new(2, 1).save(at("rgb.png")).unwrap();
    write_exr(&at("z.exr"), FlatSamples::F32(vec![0.2, 0.0]));
    let forward = "projection = [1,0,0,0, 0,1,0,0, 0,0,-1,-0.1, 0,0,-1,0]\n";
    for (camera, keys, words) in [
        (
            CAMERA,
            "file = \"short.raw\"\nalong = \"ndc\"\n",
            "12 bytes; 2x1 pixels of float32",
        ),
        (
            CAMERA,
            "file = \"rgb.png\"\nalong = \"ndc\"\n",
            "depths are 16-bit grey",
        ),
        (
            CAMERA,
            "file = \"d.raw\"\nalong = \"ndc\"\n",
            "3 at column 0, row 0",
        ),
        (
            CAMERA,
            "file = \"d.raw\"\nalong = \"ndc\"\n",
            "if they are lengths, give `along = \"axis\"`",
        ),
        (
            CAMERA,
            "file = \"d.raw\"\nchannel = \"Z\"\n",
            "only OpenEXR files have channels",
        ),
        (
            CAMERA,
            "file = \"z.exr\"\nchannel = \"Q\"\n",
            "no channel `Q`; channels: Z",
        ),
        (
            CAMERA,
            "file = \"no.png\"\nalong = \"ndc\"\n",
            "cannot read",
        ),
        (
            CAMERA,
            "file = \"d.raw\"\nrange = \"0..1\"\n",
            "9:9: depth.range: it is for depths that are no lengths",
        ),
        (
            LOOKS,
            "file = \"d.raw\"\nalong = \"ndc\"\n",
            "9:9: depth.along: such depths are behind a projection",
        ),
        (
            LOOKS,
            "file = \"d.raw\"\nalong = \"ndc\"\nprojection = [1, 2]\n",
            "found 2 numbers",
        ),
        (
            LOOKS,
            "file = \"d.raw\"\nalong = \"ndc\"\nprojection = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n",
            "is orthographic, the other is not",
        ),
        (
            LOOKS,
            &format!("file = \"minus.raw\"\nalong = \"ndc\"\n{forward}"),
            "give `range = \"-1..1\"`",
        ),
    ] {
        let found = depths(folder, camera, keys).unwrap_err();
        assert!(
            found.contains(words) && !found.contains('\n'),
            "{keys}{found}"
        );
    }
}
