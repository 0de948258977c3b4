//! Euclidean clustering.

use nalgebra::Point3;

/// Groups of points connected by gaps of at most about `gap_m`, as indices, the largest group first.
///
/// Points fall into voxels of edge `gap_m`; voxels that touch, also by a corner, are one group. So points
/// nearer than `gap_m` are always connected, and points farther apart than `2 √3 gap_m` never directly.
pub(super) fn euclidean_clusters(points: &[Point3<f64>], gap_m: f64) -> Vec<Vec<usize>> {
    let mut by_voxel: Vec<(u64, usize)> =
        points.iter().enumerate().map(|(i, p)| (voxel(p, gap_m), i)).collect();
    by_voxel.sort_unstable();
    let mut starts: Vec<usize> = Vec::new();
    for (i, (key, _)) in by_voxel.iter().enumerate() {
        if i == 0 || by_voxel[i - 1].0 != *key {
            starts.push(i);
        }
    }
    let keys: Vec<u64> = starts.iter().map(|s| by_voxel[*s].0).collect();
    let mut parents: Vec<usize> = (0..keys.len()).collect();
    let offsets: Vec<u64> = earlier_neighbours().map(step).collect();
    for (here, key) in keys.iter().enumerate() {
        for offset in &offsets {
            if let Ok(there) = keys[..here].binary_search(&key.wrapping_sub(*offset)) {
                let (a, b) = (root(&mut parents, here), root(&mut parents, there));
                parents[a.max(b)] = a.min(b);
            }
        }
    }
    let mut clusters: Vec<Vec<usize>> = vec![Vec::new(); keys.len()];
    for (at, start) in starts.iter().enumerate() {
        let end = starts.get(at + 1).copied().unwrap_or(by_voxel.len());
        let cluster = root(&mut parents, at);
        clusters[cluster].extend(by_voxel[*start..end].iter().map(|(_, i)| *i));
    }
    clusters.retain(|c| !c.is_empty());
    clusters.iter_mut().for_each(|c| c.sort_unstable());
    clusters.sort_by(|a, b| b.len().cmp(&a.len()).then(a[0].cmp(&b[0])));
    clusters
}

/// The voxel of a point, in one number that sorts by x, y, z: 21 bits each, enough for kilometres of millimetres.
fn voxel(p: &Point3<f64>, gap_m: f64) -> u64 {
    let [x, y, z] = [p.x, p.y, p.z].map(|c| ((c / gap_m).floor() as i64 + MIDDLE) as u64);
    (x << 42) + (y << 21) + z
}

/// What lies between a voxel and an earlier neighbour.
fn step([x, y, z]: [i64; 3]) -> u64 {
    -((x << 42) + (y << 21) + z) as u64
}

/// Coordinates are stored from here on, so that neighbours never cross zero.
const MIDDLE: i64 = 1 << 20;

/// The 13 of 26 neighbours that come earlier in lexicographic order.
fn earlier_neighbours() -> impl Iterator<Item = [i64; 3]> {
    (-1..=1)
        .flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| [x, y, z])))
        .filter(|offset| *offset < [0, 0, 0])
}

fn root(parents: &mut [usize], mut at: usize) -> usize {
    while parents[at] != at {
        parents[at] = parents[parents[at]];
        at = parents[at];
    }
    at
}
