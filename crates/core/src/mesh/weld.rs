//! Vertices at the same position.

use std::num::NonZero;

use glam::DVec3;

use crate::buckets::Buckets;
use crate::ids::VertexId;
use crate::parallel;

/// Each vertex at the position of an earlier one, with the first one there. Linear time unless hashes collide.
pub(super) fn repeated(positions: &[DVec3]) -> Vec<(VertexId, VertexId)> {
    // Adding 0.0 turns -0.0 into 0.0.
    let bits_of = |v: u32| positions[v as usize].to_array().map(|x| (x + 0.0).to_bits());
    let hash = |v: u32| {
        let mix = |h: u64, x: &u64| ((h ^ x) ^ (h >> 29)).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(32);
        // The lower half has what the product mixed best.
        bits_of(v).iter().fold(0, mix) as u32
    };
    // In buckets by the first bits of their hashes, each with a table that stays in the cache.
    const PIECE: usize = 1 << 13;
    let pieces = positions.len().div_ceil(PIECE);
    let bits = pieces.next_power_of_two().ilog2();
    let buckets = Buckets::new(
        pieces,
        |p| (p * PIECE..((p + 1) * PIECE).min(positions.len())).map(|v| (hash(v as u32), v as u32)).collect(),
        1 << bits,
        |&(hash, _)| (u64::from(hash) << bits >> 32) as usize,
    );
    let repeated = parallel::map(buckets.count(), |bucket| {
        let count = buckets.bucket(bucket).count();
        let slots = (2 * count).next_power_of_two();
        // For each slot the hash of a vertex and one more than its number.
        let mut table: Vec<(u32, Option<NonZero<u32>>)> = vec![(0, None); slots];
        let mut repeated = Vec::new();
        // Of each position the first vertex comes first.
        for &(hash, v) in buckets.bucket(bucket) {
            let mut slot = ((u64::from(hash << bits) * slots as u64) >> 32) as usize;
            loop {
                match &mut table[slot] {
                    (other_hash, Some(number)) => {
                        let other = number.get() - 1;
                        if *other_hash == hash && bits_of(other) == bits_of(v) {
                            repeated.push((VertexId(v), VertexId(other)));
                            break;
                        }
                    }
                    free => {
                        *free = (hash, NonZero::new(v + 1));
                        break;
                    }
                }
                slot = (slot + 1) % slots;
            }
        }
        repeated
    });
    repeated.concat()
}
