//! The weight of a joined path among all strategies that could have found it.
//!
//! Of two neighbouring strategies, one finds vertex v_t from the bundle where the other finds it from the light; all else is alike. So
//! the densities of the whole path are in the ratio
//!
//! ```text
//! p_{t+1} / p_t = p_eye(v_t) / p_light(v_t),
//! ```
//!
//! and the sum over all strategies is had by walking from the joint to both ends. Strategies that would join at a mirror cannot find the
//! path; where a density is a delta function from both sides, the two cancel. Source: Veach 1997, §10.2.1.

use super::super::Heuristic;
use super::joint::Joint;
use super::subpath::Node;

/// What one vertex is to the strategies.
#[derive(Clone, Copy, Debug)]
struct Odds {
    /// (density from the other end) / (density from its own).
    ratio: f64,
    /// A strategy cannot join at it.
    is_delta: bool,
}

/// The weight of the strategy that joins these two paths, in (0, 1].
pub(super) fn weight(heuristic: Heuristic, light: &[Node<'_>], eye: &[Node<'_>], joint: &Joint) -> f64 {
    // The bundle's first vertex is found from the bundle by every strategy; the light's first may be met.
    let is_met = light.is_empty();
    let others = others(heuristic, odds(eye, &joint.eye_reverse, is_met), eye.len() - 1, false)
        + others(heuristic, odds(light, &joint.light_reverse, false), light.len(), true);
    1.0 / (1.0 + others)
}

/// A half path's vertices from the joint to the end. An emitter that `is_met` sends out light as if it were no mirror, whatever else it is.
fn odds<'n>(nodes: &'n [Node<'_>], at_joint: &'n [f64; 2], is_met: bool) -> impl Iterator<Item = Odds> + 'n {
    nodes.iter().rev().enumerate().map(move |(k, node)| Odds {
        ratio: at_joint.get(k).copied().unwrap_or(node.reverse) / node.forward,
        is_delta: node.is_delta() && !(is_met && k == 0),
    })
}

/// Σ (p / p of the joint's)^β over the strategies that join further towards one end, moving past at most `n_moves` vertices. The last move
/// leaves that half empty if `may_be_empty`, and then nothing is joined: an emitter is met.
fn others(heuristic: Heuristic, odds: impl Iterator<Item = Odds>, n_moves: usize, may_be_empty: bool) -> f64 {
    let mut odds = odds.peekable();
    let (mut product, mut sum) = (1.0, 0.0);
    for _ in 0..n_moves {
        let Some(moved) = odds.next() else { break };
        product *= if moved.is_delta { 1.0 } else { moved.ratio };
        if product == 0.0 {
            break;
        }
        let can_join = match odds.peek() {
            Some(next) => !moved.is_delta && !next.is_delta,
            None => may_be_empty,
        };
        if can_join {
            sum += heuristic.power(product);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Stream;

    /// The weights of one path's strategies, from the densities of its vertices v₀ … v_k from either end.
    fn weights(heuristic: Heuristic, from_eye: &[f64], from_light: &[f64], is_delta: &[bool]) -> Vec<f64> {
        let n = from_eye.len();
        let odds = |j: usize, own: &[f64], other: &[f64]| Odds { ratio: other[j] / own[j], is_delta: is_delta[j] };
        (1..=n)
            .map(|t| {
                let is_possible = t == n || !(is_delta[t - 1] || is_delta[t]);
                let eye = (0..t).rev().map(|j| odds(j, from_eye, from_light));
                let light = (t..n).map(|j| odds(j, from_light, from_eye));
                let sum = others(heuristic, eye, t - 1, false) + others(heuristic, light, n - t, true);
                if is_possible { 1.0 / (1.0 + sum) } else { 0.0 }
            })
            .collect()
    }

    #[test]
    fn weights_of_a_path_sum_to_one_and_follow_the_densities() {
        let mut stream = Stream::new(0x0dd5, 0, 0);
        for n in 1..8 {
            let mut density = || (0..n).map(|_| (10.0 * stream.uniform() - 5.0).exp()).collect::<Vec<_>>();
            let (from_eye, from_light) = (density(), density());
            // Mirrors anywhere but on the bundle and on the emitter.
            for mirrors in 0_u32..1 << n {
                let is_delta: Vec<bool> = (0..n).map(|j| mirrors >> j & 1 == 1).collect();
                if is_delta[0] || is_delta[n - 1] {
                    continue;
                }
                for heuristic in [Heuristic::Balance, Heuristic::Power] {
                    let weights = weights(heuristic, &from_eye, &from_light, &is_delta);
                    let sum: f64 = weights.iter().sum();
                    assert!((sum - 1.0).abs() < 1e-13, "{n} vertices, {mirrors:b}: {weights:?}");

                    // p of strategy t, up to what all share; a mirror's densities are the same from both ends.
                    let factor = |j: usize, own: &[f64]| if is_delta[j] { 1.0 } else { own[j] };
                    let p = |t: usize| {
                        let eye: f64 = (1..t).map(|j| factor(j, &from_eye)).product();
                        heuristic.power(eye * (t..n).map(|j| factor(j, &from_light)).product::<f64>())
                    };
                    let whole = weights[n - 1] / p(n);
                    let follows =
                        |t: usize| weights[t - 1] == 0.0 || (weights[t - 1] / p(t) / whole - 1.0).abs() < 1e-10;
                    assert!((1..=n).all(follows), "{n} vertices, {mirrors:b}: {weights:?}");
                }
            }
        }
    }
}
