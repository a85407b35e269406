//! The nodes of the kernels' sums: the composite Simpson rule (Watanabe, Abe, Konno 2015, eq. 23), and strata (Cook
//! 1986).

use super::pack::layout::Node;
use crate::scene::Decay;

/// Returns the beginnings of equal strata of `[0,1]`, each weighted with its length.
pub(super) fn strata(divisions: u32) -> Vec<Node> {
    let length = 1.0 / f64::from(divisions);
    let node = |k: u32| Node {
        s: (f64::from(k) * length) as f32,
        weight: length as f32,
    };
    (0..divisions).map(node).collect()
}

/// Returns the nodes of Simpson's rule over s in `[0,1]`: the weights 1, 4, 2, 4, .., 4, 1 over 3 n, times the decay.
pub(super) fn simpson(divisions: u32, decay: Option<Decay>) -> Vec<Node> {
    let count = f64::from(divisions);
    let node = |k: u32| {
        let s = f64::from(k) / count;
        let is_end = k == 0 || k == divisions;
        let factor = if is_end {
            1.0
        } else {
            f64::from(2 + 2 * (k % 2))
        };
        let weight = factor / (3.0 * count);
        Node {
            s: s as f32,
            weight: (weight * decay.map_or(1.0, |decay| decay.at(s))) as f32,
        }
    };
    (0..=divisions).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_integrates_cubics_and_weighs_with_the_decay() {
        for divisions in [2, 4, 10] {
            let nodes = simpson(divisions, None);
            let sum: f64 = nodes
                .iter()
                .map(|node| f64::from(node.weight) * f64::from(node.s).powi(3))
                .sum();
            assert!((sum - 0.25).abs() < 1e-7, "{divisions}: {sum}");
        }
        let decay = Decay::new(0.1, 0.5);
        let (plain, decayed) = (simpson(4, None), simpson(4, Some(decay)));
        let ratio = f64::from(decayed[2].weight / plain[2].weight);
        assert!((ratio - 0.1).abs() < 1e-7, "{ratio}");
    }
}
