//! How a change at some points fades out over the skin around them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::skin::Skin;

/// Points within `reach` of `sources` along the edges of the skinned mesh: 0 at the sources, smoothly to 1.
pub(super) fn eased(skin: &Skin, places: &[DVec3], sources: &[u32], reach: f64) -> Vec<(u32, f64)> {
    let mut distances: std::collections::BTreeMap<u32, f64> = sources.iter().map(|&point| (point, 0.0)).collect();
    // Distances are not negative: their bits are in their order.
    let mut next: BinaryHeap<Reverse<(u64, u32)>> = sources.iter().map(|&point| Reverse((0, point))).collect();
    while let Some(Reverse((bits, point))) = next.pop() {
        let distance = f64::from_bits(bits);
        if distances.get(&point).is_some_and(|known| *known < distance) {
            continue;
        }
        for &other in skin.neighbours.row(point as usize) {
            let farther = distance + places[point as usize].distance(places[other as usize]);
            if farther < reach && distances.get(&other).is_none_or(|known| farther < *known) {
                distances.insert(other, farther);
                next.push(Reverse((farther.to_bits(), other)));
            }
        }
    }
    let smooth = |x: f64| x * x * (3.0 - 2.0 * x);
    distances.into_iter().map(|(point, distance)| (point, if distance > 0.0 { smooth(distance / reach) } else { 0.0 })).collect()
}
