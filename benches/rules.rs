//! Where the rules of the method `exact` come from (`src/wave/rule.rs`): error and cost of every number of nodes and
//! every threshold, on random scenes of one ring or one curve. `cargo bench --bench rules`
#![allow(clippy::unwrap_used, clippy::expect_used)] // a bench that fails stops

#[path = "../tests/common/random.rs"]
#[allow(dead_code)] // what the tests use besides
mod random;

use energywave::image::compare;
use energywave::internals::{Rule, set_rule};
use energywave::scene::{Method, Sampling};
use energywave::{Device, RadianceImage, Renderer, RendererOptions, Scene, reference};
use random::{Kind, scene_of};

const SCENES: u64 = 40;
const SIZE: u32 = 48;
const NODES: [u32; 4] = [4, 6, 8, 10];
const THRESHOLDS: [f32; 10] = [1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6];

fn renderer(rule: Rule, counts_samples: bool) -> Renderer {
    let choice = std::env::var("ENERGYWAVE_DEVICE").unwrap_or_else(|_| "cpu".to_owned());
    let mut options = RendererOptions::default();
    options.counts_samples = counts_samples;
    let device = Device::select(&choice).unwrap();
    let mut renderer = Renderer::with_options(&device, &options).unwrap();
    set_rule(&mut renderer, rule);
    renderer
}

/// Relative errors of all pixels of all scenes, in rising order.
fn errors(rule: Rule, scenes: &[(Scene, RadianceImage)]) -> Vec<f64> {
    let mut renderer = renderer(rule, false);
    let mut errors = Vec::new();
    for (scene, expected) in scenes {
        let image = renderer.render(scene).unwrap();
        let pairs = image.as_slice().iter().zip(expected.as_slice());
        let red = pairs.step_by(4);
        errors.extend(red.map(|(a, b)| (f64::from(*a) / f64::from(*b) - 1.0).abs()));
        assert!(compare(&image, expected).is_some());
    }
    errors.sort_by(f64::total_cmp);
    errors
}

/// Nodes that an average pixel takes.
fn nodes(rule: Rule, scenes: &[(Scene, RadianceImage)]) -> f64 {
    let mut renderer = renderer(rule, true);
    let counts = scenes.iter().map(|(scene, _)| {
        renderer.render(scene).unwrap();
        renderer.last_cost().samples as f64 / scene.image.pixels() as f64
    });
    counts.sum::<f64>() / scenes.len() as f64
}

fn main() {
    for kind in [Kind::Torus, Kind::Curve] {
        let scenes: Vec<_> = (0..SCENES)
            .map(|seed| {
                let mut scene = scene_of(kind, seed, SIZE);
                scene.integration.method = Method::Exact {
                    tolerance: 1e-3,
                    sampling: Sampling::Pixels,
                };
                let expected = reference::render(&scene).unwrap();
                (scene, expected)
            })
            .collect();
        println!("{kind:?}: {SCENES} scenes of {SIZE}x{SIZE} pixels");
        println!("nodes threshold   99 %    99.9 %       max  nodes a pixel");
        for nodes_of_panel in NODES {
            for threshold in THRESHOLDS {
                let rule = Rule {
                    nodes: nodes_of_panel,
                    coarse: false,
                    smooth_threshold: threshold,
                    kinked_threshold: threshold,
                };
                let errors = errors(rule, &scenes);
                let at = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize];
                println!(
                    "{nodes_of_panel:>5} {threshold:>9.0e} {:>6.0e} {:>9.1e} {:>9.1e} {:>14.1}",
                    at(0.99),
                    at(0.999),
                    at(1.0),
                    nodes(rule, &scenes)
                );
            }
        }
    }
}
