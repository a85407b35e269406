//! What stands below the options in every `--help`: examples, each a line that can be typed as it stands.

pub const PROGRAM: &str = "\
Examples:
  energywave new laser
  energywave render laser.toml -o laser.png
  energywave help scene

Exit codes: 0 success, 2 usage, 3 scene or input file, 4 no such device, 5 device failed or out of memory, \
6 verification failed, 7 output, 130 interrupted";

pub const RENDER: &str = "\
Examples:
  energywave render laser.toml -o laser.png
  energywave render laser.toml -o laser.exr --size 320x180 --tolerance 1e-4
  energywave render laser.toml -o laser.png --device reference --quiet
  energywave render laser.toml -o laser.png --time 1.5 --fps 24
  energywave new nova -o - | energywave render - -o nova.png --size 320x180";

pub const ANIMATE: &str = "\
Examples:
  energywave animate pulse.toml -o frames/f.exr
  energywave animate pulse.toml -o f.####.png --frames 0..239 --fps 24 --shard 1/4
  energywave animate pulse.toml -o pulse.apng --size 320x180
  energywave animate pulse.toml -o pulse.png --flipbook 8x8 --padding 2 --size 128x128
  energywave animate pulse.toml -o - > pulse.y4m";

pub const WATCH: &str = "\
Examples:
  energywave watch laser.toml -o laser.png
  energywave watch laser.toml -o laser.png --size 320x180 --time 1.5

Without -o, in a window, of a program that was built with it (cargo install --features window): space stops and goes \
on, arrow keys go from frame to frame, dragging turns the camera, with the right button it goes through the time, the \
wheel comes closer, Home goes back, Esc ends. A red frame means that the scene has a fault; the title says which.";

pub const BAKE: &str = "\
Examples:
  energywave bake nova.toml -o nova.vdb --cells 256
  energywave bake laser.toml -o laser.vdb --cells 256 --box 0,0,0 4,1,1 --half
  energywave bake nova.toml -o nova.raw --mean 4 --time 0.5";

pub const EXPORT: &str = "\
Examples:
  energywave export beam.toml --to wgsl -o beam.wgsl
  energywave export beam.toml --to glsl -o beam.frag --uniforms beam.bin --time 1.5
  energywave export beam.toml --to hlsl -o beam.hlsl --entry function";

pub const NEW: &str = "\
Examples:
  energywave new --list
  energywave new laser
  energywave new magic-circle -o circle.toml --force";

pub const DEVICES: &str = "\
Examples:
  energywave devices
  energywave devices --json";

pub const BENCH: &str = "\
Examples:
  energywave bench --table 2
  energywave bench laser.toml --size 1920x1080
  energywave bench --table 3 --json --seconds 5
  energywave bench --table 2 --csv > table-2.csv";

pub const COMPARE: &str = "\
Examples:
  energywave compare laser.toml --size 64x64 --map errors.png --map errors.exr
  energywave compare laser.toml --size 128x128 --json";

pub const CONTACTS: &str = "\
Examples:
  energywave contacts splash.toml --frames 0..119
  energywave contacts splash.toml -o contacts.json";

pub const FIGURES: &str = "\
Examples:
  energywave figures -o figures
  energywave figures -o figures --size 512x512";

pub const VERIFY: &str = "\
Examples:
  energywave verify
  energywave verify --device gpu --tolerance 1e-5 --json";

pub const SCHEMA: &str = "\
An editor with Taplo (Even Better TOML) completes a scene whose first line is
  #:schema scene.schema.json

Examples:
  energywave schema > scene.schema.json";

pub const COMPLETIONS: &str = "\
Examples:
  energywave completions bash > energywave.bash
  energywave completions zsh > _energywave";

pub const MAN: &str = "\
Examples:
  energywave man > energywave.1
  energywave man render > energywave-render.1";

pub const HELP: &str = "\
Examples:
  energywave help render
  energywave help scene
  energywave help scene torus";

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};

    use crate::cli::args::Arguments;

    /// Returns the examples of a text: what stands on lines that begin with the program's name, by pipes.
    fn examples(help: &str) -> Vec<String> {
        let lines = help.lines().filter_map(|line| line.strip_prefix("  "));
        let lines = lines.filter(|line| line.starts_with("energywave "));
        lines
            .flat_map(|line| line.split(" | ").map(str::to_owned))
            .collect()
    }

    #[test]
    fn every_help_has_examples_and_all_can_be_typed() {
        let mut program = Arguments::command();
        program.build();
        let parse = |example: &str| {
            let typed = example.split(" > ").next().unwrap_or_default();
            Arguments::try_parse_from(typed.split(' '))
        };
        let mut helps = vec![program.clone()];
        helps.extend(program.get_subcommands().cloned());
        for mut command in helps {
            let help = command.render_long_help().to_string();
            let examples = examples(&help);
            assert!(!examples.is_empty(), "{help}");
            for example in examples {
                assert!(parse(&example).is_ok(), "{example}");
            }
        }
        assert!(parse("energywave render laser.toml").is_err());
    }
}
