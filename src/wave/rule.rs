//! The quadrature of the method `exact`: how many Gauss-Legendre nodes a panel has, and when it counts as resolved.

/// A rule for every panel. A panel is resolved where the two highest Legendre coefficients that its nodes see stay
/// below a threshold, relative to the integral.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rule {
    /// Nodes of a panel, an even number.
    pub nodes: u32,
    /// Whether a relative error of 2^-14 at each node does not matter.
    pub coarse: bool,
    /// The threshold of fields that are smooth along a ray, such as a torus'.
    pub smooth_threshold: f32,
    /// The threshold of fields with kinks and jumps, such as a curve's.
    pub kinked_threshold: f32,
}

/// The least tolerance for which a rule serves, and the rule: `cargo bench --bench rules` shows what each is good for.
const RULES: [(f64, Rule); 5] = [
    (1e-2, rule(8, 1e-1, 3e-3)),
    (1e-3, rule(8, 2e-3, 2e-4)),
    (1e-4, rule(10, 5e-5, 2e-5)),
    (1e-5, rule(10, 1e-5, 5e-6)),
    (0.0, rule(10, 3e-6, 2e-6)),
];

/// The loosest tolerance whose rule finds peaks that are sharper than that of 1 over the distance on a smooth panel.
const MOST_FOR_SHARP_PEAKS: f64 = 1e-3;

/// By how much less each source may be off where sources of opposite signs cancel: their light is then several times
/// that of a pixel.
const CANCELLED: f64 = 1.0 / 30.0;

/// By how much less squares of fields may be off, whose peaks are sharper than those of fields.
const SQUARED: f64 = 0.3;

const fn rule(nodes: u32, smooth_threshold: f32, kinked_threshold: f32) -> Rule {
    Rule {
        nodes,
        coarse: nodes <= 8,
        smooth_threshold,
        kinked_threshold,
    }
}

impl Rule {
    /// Chooses the rule that meets a tolerance. A loose threshold of smooth fields may miss sharp peaks, such as those
    /// of fields that fall off with the squared distance.
    pub fn of(tolerance: f64, has_sharp_peaks: bool, has_both_signs: bool) -> Self {
        let share = if has_both_signs { CANCELLED } else { 1.0 };
        let rule = Self::serving(tolerance * share);
        if !has_sharp_peaks {
            return rule;
        }
        let of_peaks = Self::serving(tolerance.min(MOST_FOR_SHARP_PEAKS) * share);
        Self {
            smooth_threshold: of_peaks.smooth_threshold,
            ..rule
        }
    }

    fn serving(wanted: f64) -> Self {
        let serves = |(tolerance, _): &&(f64, Self)| wanted >= *tolerance;
        let [.., (_, strictest)] = RULES;
        RULES
            .iter()
            .find(serves)
            .map_or(strictest, |(_, rule)| *rule)
    }

    /// Chooses the rule that meets a tolerance where fields are squared.
    pub fn of_squares(tolerance: f64) -> Self {
        Self::of(SQUARED * tolerance.min(MOST_FOR_SHARP_PEAKS), true, false)
    }

    /// Gives the rule as the kernels' compiler gets it: nodes in (0,1), their weights, and those weights times the
    /// Legendre polynomials of the two highest degrees that the nodes can tell apart, one even, one odd.
    pub fn definitions(&self) -> String {
        let count = self.nodes as usize;
        let nodes: Vec<Node> = gauss_legendre(count);
        let list = |value: fn(&Node, usize) -> f64| {
            let values: Vec<String> = nodes
                .iter()
                .map(|node| format!("{:.9e}f", value(node, count)))
                .collect();
            values.join(",")
        };
        format!(
            " -D EXACT -D GAUSS_PAIRS={} -D GAUSS_NODES={{{}}} -D GAUSS_WEIGHTS={{{}}} -D GAUSS_NULL_EVEN={{{}}} \
             -D GAUSS_NULL_ODD={{{}}}{}",
            count / 2,
            list(|node, _| node.x),
            list(|node, _| node.weight),
            list(|node, count| node.weight * legendre(count - 2, node.x).0),
            list(|node, count| node.weight * legendre(count - 1, node.x).0),
            if self.coarse { " -D COARSE" } else { "" }
        )
    }
}

/// A positive node of the Gauss-Legendre rule on `[-1,1]`, and its weight.
#[derive(Debug, Clone, Copy)]
struct Node {
    x: f64,
    weight: f64,
}

/// Returns the positive nodes of the rule with `count` nodes, an even number, by Newton's method.
fn gauss_legendre(count: usize) -> Vec<Node> {
    let node = |k: usize| {
        let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (count as f64 + 0.5)).cos();
        for _ in 0..10 {
            let (value, slope) = legendre(count, x);
            x -= value / slope;
        }
        let slope = legendre(count, x).1;
        Node {
            x,
            weight: 2.0 / ((1.0 - x * x) * slope * slope),
        }
    };
    (0..count / 2).map(node).collect()
}

/// Returns the Legendre polynomial of a degree and its derivative, |x| < 1.
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (0.0, 1.0);
    for k in 0..degree {
        let k = k as f64;
        let next = ((2.0 * k + 1.0) * x * value - k * before) / (k + 1.0);
        (before, value) = (value, next);
    }
    (value, degree as f64 * (x * value - before) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_integrates_polynomials_up_to_twice_its_nodes() {
        for count in [2, 4, 6, 8, 10, 16] {
            let nodes = gauss_legendre(count);
            assert_eq!(nodes.len(), count / 2);
            for degree in (0..2 * count).step_by(2) {
                let term = |node: &Node| 2.0 * node.weight * node.x.powi(degree as i32);
                let sum: f64 = nodes.iter().map(term).sum();
                let exact = 2.0 / (degree as f64 + 1.0);
                assert!((sum / exact - 1.0).abs() < 1e-13, "{count} {degree}: {sum}");
            }
            let term = |node: &Node| 2.0 * node.weight * node.x.powi(2 * count as i32);
            let sum: f64 = nodes.iter().map(term).sum();
            let exact = 2.0 / (2.0 * count as f64 + 1.0);
            assert!((sum / exact - 1.0).abs() > 1e-12, "{count}: {sum}");
        }
    }

    #[test]
    fn stricter_tolerances_have_stricter_rules() {
        let rule = |tolerance| Rule::of(tolerance, false, false);
        let tolerances = [0.5, 1e-1, 3e-2, 1e-2, 1e-3, 1e-4, 1e-5, 1e-12];
        for pair in tolerances.windows(2) {
            let (loose, strict) = (rule(pair[0]), rule(pair[1]));
            assert!(strict.nodes >= loose.nodes);
            assert!(strict.smooth_threshold <= loose.smooth_threshold);
            assert!(strict.kinked_threshold <= loose.kinked_threshold);
        }
        assert_eq!(rule(1e-3), rule(2e-3));
        assert_ne!(rule(1e-3), rule(0.9e-3));
        assert_eq!(Rule::of(3e-3, false, true), rule(1e-4));
        assert_eq!(Rule::of_squares(1e-2), rule(1e-4));
    }
}
