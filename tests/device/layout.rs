//! The device structs agree between host and device: sizes in every build (`CHECK_SIZE` beside each struct in `cl/`),
//! offsets at compile time (`src/opencl/layout.rs`), and here every field by its name.

use crate::common;
use energywave::internals::pack::layout::STRUCTS;
use energywave::internals::{
    self, BloomStep, CROWD_STRUCTS, DeviceBuffer, DeviceStruct, GLOW_STRUCTS, KINDS, LIGHT_STRUCTS,
    MESH_STRUCTS, METABALL_STRUCTS, StoredDepths, StructLayout, TEXTURE_STRUCTS,
    host_depth_definitions,
};

const BLOOM_STEP: StructLayout = BloomStep::LAYOUT;

/// A kernel that copies every 32-bit word of every field, reached by the field's name, in the order of the host's list.
fn copy_fields(layout: &StructLayout, files: &str) -> String {
    let copies: String = layout
        .fields
        .iter()
        .map(|(field, _, size)| {
            format!(
                "    for (uint word = 0; word < {}; ++word)\n        \
                 words[next++] = ((__global const uint *)&record->{field})[word];\n",
                size / 4
            )
        })
        .collect();
    format!(
        "{files}__kernel void copy_fields(__global const {} *record, __global uint *words) {{\n    \
         uint next = 0;\n{copies}}}\n",
        layout.name
    )
}

/// Where the structs of the wave and of the film are.
const FILES: &str = "#include \"film.h\"\n#include \"view.h\"\n#include \"wave/kinds.h\"\n#include \"wave/types.h\"\n";

fn is_of_metaballs(layout: &StructLayout) -> bool {
    METABALL_STRUCTS.iter().any(|it| it.name == layout.name)
}

fn is_of_glow(layout: &StructLayout) -> bool {
    GLOW_STRUCTS.iter().any(|it| it.name == layout.name)
}

fn is_of_crowds(layout: &StructLayout) -> bool {
    CROWD_STRUCTS.iter().any(|it| it.name == layout.name)
}

fn is_of_textures(layout: &StructLayout) -> bool {
    TEXTURE_STRUCTS.iter().any(|it| it.name == layout.name)
}

fn is_of_light(layout: &StructLayout) -> bool {
    LIGHT_STRUCTS.iter().any(|it| it.name == layout.name)
}

fn is_of_meshes(layout: &StructLayout) -> bool {
    MESH_STRUCTS.iter().any(|it| it.name == layout.name)
}

fn words_by_name(layout: &StructLayout) -> Vec<u32> {
    let files = match () {
        () if layout.name == BLOOM_STEP.name => "#include \"film.h\"\n#include \"bloom/step.h\"\n",
        () if is_of_metaballs(layout) => "#include \"metaball/types.h\"\n",
        () if is_of_glow(layout) => "#include \"glow/types.h\"\n",
        () if is_of_crowds(layout) => "#include \"crowd/types.h\"\n",
        () if is_of_textures(layout) => "#include \"texture/types.h\"\n",
        () if is_of_light(layout) => "#include \"light/types.h\"\n",
        () if is_of_meshes(layout) => "#include \"mesh/types.h\"\n",
        () => FILES,
    };
    words_of(layout, files, "")
}

/// The words that the device finds in a record whose word k is k + 1.
#[allow(unsafe_code)]
fn words_of(layout: &StructLayout, files: &str, definitions: &str) -> Vec<u32> {
    let compute = common::compute();
    let count = layout.size / 4;
    let record: Vec<u32> = (1..=count as u32).collect();
    let mut input = DeviceBuffer::new(&compute, "record", count).unwrap();
    input.write(&compute, &record).unwrap();
    let mut output = DeviceBuffer::<u32>::new(&compute, "words", count).unwrap();
    output.write(&compute, &vec![0; count]).unwrap();
    let text = copy_fields(layout, files);
    let options = common::options(1, definitions);
    let name = "copy_fields.cl";
    let program = match () {
        () if layout.name == BLOOM_STEP.name => {
            internals::build_bloom_text(&compute, name, &text, &options)
        }
        () if is_of_metaballs(layout) => {
            internals::build_metaball_text(&compute, name, &text, &options)
        }
        () if is_of_glow(layout) => internals::build_glow_text(&compute, name, &text, &options),
        () if is_of_crowds(layout) => internals::build_crowd_text(&compute, name, &text, &options),
        () if is_of_textures(layout) => {
            internals::build_texture_text(&compute, name, &text, &options)
        }
        () if is_of_meshes(layout) || is_of_light(layout) => {
            internals::build_mesh_text(&compute, name, &text, &options)
        }
        () => internals::build_text(&compute, name, &text, &KINDS, &options),
    }
    .unwrap();
    // SAFETY: the kernel reads and writes as many words as the record has.
    unsafe {
        internals::run(
            &compute,
            &program,
            "copy_fields",
            &[("record", &input), ("words", &output)],
            1,
            1,
        )
    }
    .unwrap();
    let mut words = vec![0; count];
    output.read(&compute, &mut words).unwrap();
    words
}

#[test]
fn the_device_finds_every_field_where_the_host_put_it() {
    for layout in STRUCTS
        .iter()
        .chain([&BLOOM_STEP])
        .chain(METABALL_STRUCTS)
        .chain(GLOW_STRUCTS)
        .chain(CROWD_STRUCTS)
        .chain(TEXTURE_STRUCTS)
        .chain(MESH_STRUCTS)
        .chain(LIGHT_STRUCTS)
    {
        let expected: Vec<u32> = (1..=layout.size as u32 / 4).collect();
        assert_eq!(words_by_name(layout), expected, "{}", layout.name);
    }
    let expected: Vec<u32> = (1..=size_of::<StoredDepths>() as u32 / 4).collect();
    let (files, definitions) = ("#include \"depth.cl\"\n", host_depth_definitions());
    assert_eq!(
        words_of(&StoredDepths::LAYOUT, files, &definitions),
        expected
    );
}

#[test]
fn two_swapped_fields_are_noticed() {
    let torus = STRUCTS.iter().find(|s| s.name == "Torus").unwrap();
    let swapped: &[_] = &[
        torus.fields[1],
        torus.fields[0],
        torus.fields[2],
        torus.fields[3],
        torus.fields[4],
        torus.fields[5],
        torus.fields[6],
    ];
    let wrong = StructLayout {
        fields: Box::leak(swapped.to_vec().into_boxed_slice()),
        ..*torus
    };
    let expected: Vec<u32> = (1..=torus.size as u32 / 4).collect();
    assert_ne!(words_by_name(&wrong), expected);
}

#[test]
fn a_struct_of_another_size_stops_the_build() {
    let compute = common::compute();
    let options = common::options(1, "-DSIZEOF_TORUS=60");
    let render = "#include \"wave/render.cl\"\n";
    let error = internals::build_text(&compute, "render", render, &KINDS, &options).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("Torus_has_the_size"), "{message}");
    assert!(message.contains("cl/wave/source/torus.h"), "{message}");
}
