//! Meshes in scene files: triangles from every kind of file, what is written and read again, tracks, files that are
//! known, and every fault with its place.

use energywave::Scene;
use energywave::glam::DVec3;
use energywave::scene::{AnimatedScene, Mesh, Rotation, TriangleList};

use crate::common::program::{Folder, expect};

const CAMERA: &str = "[camera]\neye = [0.0, -9.0, 2.0]\ntarget = [0.0, 0.0, 0.0]\n[[mesh]]\n";

const CORNERS: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 0.0, 2.0],
    [0.0, 0.5, 2.0],
];
const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 0 2\nv 0 0.5 2\nf 1 2 3 4\n";

/// The corners as float32, then the indices as whole numbers of 16 bits.
fn buffer() -> Vec<u8> {
    let corners = CORNERS.into_iter().flatten().flat_map(f32::to_le_bytes);
    let indices = TRIANGLES.into_iter().flatten();
    corners
        .chain(indices.flat_map(|it| (it as u16).to_le_bytes()))
        .collect()
}

/// A glTF document of that buffer, which is elsewhere or within; `more` stands beside its nodes.
fn document(uri: &str, node: &str, primitive: &str, more: &str) -> String {
    let uri = if uri.is_empty() {
        String::new()
    } else {
        format!(r#""uri": "{uri}", "#)
    };
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0{node}}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}{primitive}}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 0.5, 2]}},
            {{"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 12}}],
        "buffers": [{{{uri}"byteLength": 60}}]{more}}}"#
    )
}

const INDICES: &str = r#", "indices": 1"#;

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let groups = bytes.chunks_exact(3); // 60 bytes
    let letters = groups.flat_map(|it| {
        let bits = u32::from_be_bytes([0, it[0], it[1], it[2]]);
        [18, 12, 6, 0].map(|shift| LETTERS[(bits >> shift & 63) as usize] as char)
    });
    letters.collect()
}

/// A binary file of a document and the buffer.
fn binary(document: &str) -> Vec<u8> {
    let mut json = document.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + buffer().len();
    let mut bytes = b"glTF".to_vec();
    for number in [2, length as u32, json.len() as u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((buffer().len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(buffer());
    bytes
}

fn expected() -> TriangleList {
    let corners = CORNERS.map(|it| DVec3::from_array(it.map(f64::from)));
    TriangleList::new(corners.to_vec(), TRIANGLES.to_vec()).unwrap()
}

#[test]
fn triangles_are_the_same_from_every_kind_of_file() {
    let folder = Folder::new();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    write("a.obj", OBJ.as_bytes());
    write("a b.bin", &buffer());
    write("a.gltf", document("a%20b.bin", "", INDICES, "").as_bytes());
    let data = format!("data:application/octet-stream;base64,{}", base64(&buffer()));
    write("b.gltf", document(&data, "", INDICES, "").as_bytes());
    write("a.glb", &binary(&document("", "", INDICES, "")));
    for name in ["a.obj", "a.gltf", "b.gltf", "a.glb"] {
        write(
            "scene.toml",
            format!("{CAMERA}file = \"{name}\"\n").as_bytes(),
        );
        let scene = Scene::from_file(folder.path().join("scene.toml")).unwrap();
        assert_eq!(scene.meshes[0].triangles, expected(), "{name}");
        let again = Scene::from_toml(&scene.to_toml().unwrap()).unwrap();
        assert_eq!(again, scene, "{name}");
        let moving = AnimatedScene::from_file(folder.path().join("scene.toml")).unwrap();
        let named: &[&str] = if name == "a.gltf" {
            &["a.gltf", "a b.bin"]
        } else {
            &[name]
        };
        let named: Vec<_> = named.iter().map(|it| folder.path().join(it)).collect();
        assert_eq!(moving.files(), named);
    }
    // A strip of the four corners, which a node moves and another one within scales.
    let nodes = r#", "translation": [5, 0, 0], "scale": [2, 2, 2]"#;
    write("c.glb", &binary(&document("", nodes, r#", "mode": 5"#, "")));
    let strip = TriangleList::from_file(folder.path().join("c.glb")).unwrap();
    assert_eq!(strip.triangles(), [[0, 1, 2], [1, 2, 3]]);
    assert_eq!(strip.vertices()[2], DVec3::new(7.0, 0.0, 4.0));
}

#[test]
fn listed_triangles_are_read_written_and_moved() {
    let text = format!(
        "{CAMERA}vertices = [[0, 0, 0], [1, 0, 0], [1, 0, 2], [0, 0.5, 2]]\ntriangles = [[0, 1, 2], [0, 2, 3], [1, 1, 2]]\n\
         scale = {{ times = [0, 1], values = [1, 3] }}\nrotate = {{ axis = [0, 0, 1], angle = 90 }}\n\
         translate = [0, 0, 1]\nalbedo = \"#ffffff\"\n"
    );
    let moving = AnimatedScene::from_toml(&text).unwrap();
    let scene = moving.at(0.5).unwrap();
    let mut mesh = Mesh::new(expected());
    mesh.scale = 2.0;
    mesh.rotate = Some(Rotation {
        axis: DVec3::Z,
        angle: 90.0,
    });
    mesh.translate = DVec3::Z;
    mesh.albedo = DVec3::ONE;
    assert_eq!(scene.meshes[0], mesh);
    let again = Scene::from_toml(&scene.to_toml().unwrap()).unwrap();
    assert_eq!(again, scene);
    let json = Scene::from_json(&scene.to_json().unwrap()).unwrap();
    assert_eq!(json, scene);
}

const TRIANGLE: &str = "vertices = [[0, 0, 0], [1, 0, 0], [0, 0, 1]]\ntriangles = [[0, 1, 2]]\n";

/// What follows the header in line 4; where the fault stands; words of the message.
const BAD: &[(&str, &str, &str)] = &[
    ("", "4:1: mesh[0].vertices", "there are no vertices"),
    (
        "vertexes = []\n",
        "5:1: mesh[0].vertexes",
        "did you mean `vertices`?",
    ),
    (
        "vertices = [[0, 0, 0], [1, 0, 0], [0, nan, 1]]\ntriangles = [[0, 1, 2]]\n",
        "5:12: mesh[0].vertices",
        "vertex 2 is at 0, NaN, 1",
    ),
    (
        "vertices = [[0, 0, 0], [1, 0, 0], [0, 0, inf]]\ntriangles = [[0, 1, 2]]\n",
        "5:12: mesh[0].vertices",
        "vertex 2 is at",
    ),
    (
        "vertices = [[0, 0, 0], [1, 0, 0], [0, 0, 1]]\n",
        "mesh[0].triangles",
        "there are no triangles",
    ),
    (
        "vertices = [[0, 0, 0], [1, 0, 0], [0, 0, 1]]\ntriangles = [[0, 1, 2], [2, 1, 3]]\n",
        "6:13: mesh[0].triangles",
        "triangle 1 names vertex 3; they are numbered 0 to 2",
    ),
    (
        "vertices = [[0, 0, 0], [1, 0, 0], [0, 0, 1]]\ntriangles = [[0, 1, -2]]\n",
        "6:13: mesh[0].triangles",
        "triangle 0 names vertex -2",
    ),
    (
        "vertices = [[0, 0, 0], [1, 0, 0], [0, 0, 1]]\ntriangles = [[0, 1, 1.5]]\n",
        "6:13: mesh[0].triangles",
        "whole numbers",
    ),
    (
        "vertices = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]\ntriangles = [[0, 1, 2], [0, 1, 1]]\n",
        "6:13: mesh[0].triangles",
        "no triangle has an area",
    ),
    (
        "TRIANGLE file = \"a.obj\"\n",
        "7:8: mesh[0].file",
        "say already what the mesh is",
    ),
    (
        "file = \"none.obj\"\n",
        "5:8: mesh[0].file",
        "none.obj: cannot read",
    ),
    (
        "file = \"a.stl\"\n",
        "5:8: mesh[0].file",
        ".obj, .gltf or .glb",
    ),
    (
        "file = \"broken.obj\"\n",
        "5:8: mesh[0].file",
        "broken.obj:2: \"x\" is no number",
    ),
    (
        "file = \"outside.obj\"\n",
        "5:8: mesh[0].file",
        "outside.obj:4: a face names vertex 9",
    ),
    (
        "file = \"empty.obj\"\n",
        "5:8: mesh[0].file",
        "there are no vertices",
    ),
    ("file = \"text.gltf\"\n", "5:8: mesh[0].file", "no glTF"),
    (
        "file = \"cut.glb\"\n",
        "5:8: mesh[0].file",
        "it is cut off or damaged",
    ),
    (
        "file = \"draco.gltf\"\n",
        "5:8: mesh[0].file",
        "KHR_draco_mesh_compression",
    ),
    (
        "file = \"short.gltf\"\n",
        "5:8: mesh[0].file",
        "buffer 0 has 3 bytes, and should have 60",
    ),
    (
        "file = \"lost.gltf\"\n",
        "5:8: mesh[0].file",
        "cannot read lost.bin",
    ),
    ("file = \"skin.gltf\"\n", "5:8: mesh[0].file", "has a skin"),
    (
        "file = \"morph.gltf\"\n",
        "5:8: mesh[0].file",
        "morph targets",
    ),
    (
        "file = \"turns.gltf\"\n",
        "5:8: mesh[0].file",
        "deeper than 64",
    ),
    (
        "TRIANGLE scale = 0\n",
        "7:10: mesh[0].scale",
        "must be positive",
    ),
    (
        "TRIANGLE scale = -1\n",
        "7:10: mesh[0].scale",
        "must be positive",
    ),
    (
        "TRIANGLE translate = [1e9, 0, 0]\n",
        "7:14: mesh[0].translate",
        "beyond 1e9",
    ),
    (
        "TRIANGLE albedo = [0.5, 1.5, 0]\n",
        "7:11: mesh[0].albedo",
        "0 to 1",
    ),
    (
        "TRIANGLE rotate = { axis = [0, 0, 0], angle = 1 }\n",
        "mesh[0].rotate.axis",
        "no direction",
    ),
];

#[test]
fn bad_meshes_are_refused_with_their_place_and_nothing_is_written() {
    let folder = Folder::new();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    write("broken.obj", b"v 0 0 0\nv 1 x 0\n");
    write("outside.obj", b"v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 9\n");
    write("empty.obj", b"");
    write("a.obj", OBJ.as_bytes());
    write("text.gltf", b"{ no");
    let whole = binary(&document("", "", INDICES, ""));
    write("cut.glb", &whole[..whole.len() - 5]);
    let data = format!("data:;base64,{}", base64(&buffer()));
    let draco = r#", "extensionsRequired": ["KHR_draco_mesh_compression"]"#;
    write("draco.gltf", document(&data, "", INDICES, draco).as_bytes());
    write(
        "short.gltf",
        document("data:;base64,AAAA", "", INDICES, "").as_bytes(),
    );
    write(
        "lost.gltf",
        document("lost.bin", "", INDICES, "").as_bytes(),
    );
    let skin = r#", "skins": [{"joints": [0]}]"#;
    write(
        "skin.gltf",
        document(&data, r#", "skin": 0"#, INDICES, skin).as_bytes(),
    );
    let morph = r#", "targets": [{"POSITION": 0}]"#;
    write("morph.gltf", document(&data, "", morph, "").as_bytes());
    write(
        "turns.gltf",
        document(&data, r#", "children": [0]"#, INDICES, "").as_bytes(),
    );
    for (text, place, words) in BAD {
        let text = text.replace("TRIANGLE ", TRIANGLE);
        let path = folder.path().join("bad.toml");
        std::fs::write(path, format!("{CAMERA}{text}")).unwrap();
        let render = [
            "render",
            "bad.toml",
            "-o",
            "out.png",
            "--device",
            "reference",
        ];
        let output = folder.run(&render);
        expect(&output, 3, "bad.toml:");
        expect(&output, 3, place);
        expect(&output, 3, words);
        assert!(!folder.names().contains(&"out.png".to_owned()), "{text}");
    }
}

#[test]
fn changed_bytes_of_meshes_end_in_errors() {
    let folder = Folder::new();
    let binary = binary(&document("", "", INDICES, ""));
    let data = format!("data:;base64,{}", base64(&buffer()));
    let text = document(&data, "", INDICES, "");
    let mut random = fastrand::Rng::with_seed(52);
    let (mut read, mut refused) = (0, 0);
    for (name, bytes) in [
        ("a.glb", &binary[..]),
        ("a.gltf", text.as_bytes()),
        ("a.obj", OBJ.as_bytes()),
    ] {
        for _ in 0..1500 {
            let mut bytes = bytes.to_vec();
            for _ in 0..random.usize(1..4) {
                let place = random.usize(..bytes.len());
                match random.u32(0..4) {
                    0 => bytes.truncate(place.max(1)),
                    1 => bytes[place] = random.u8(..),
                    2 => bytes[place] = b'0' + random.u8(..10),
                    _ => bytes[place] ^= 1 << random.u32(..8),
                }
            }
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            match TriangleList::from_file(&path) {
                Ok(_) => read += 1,
                Err(_) => refused += 1,
            }
        }
    }
    assert!(read > 100 && refused > 1000, "{read} {refused}");
}
