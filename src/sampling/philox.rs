//! Philox4x32-10 (Salmon et al. 2011) in a shape that compiles to vector instructions where it is called for many counters in a loop. The same
//! blocks, bit for bit, as `rand_philox` gives, whose function is called and not inlined.

/// The block of a counter.
#[inline(always)]
pub(super) fn block([mut a, mut b, mut c, mut d]: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for round in 0..10 {
        if round > 0 {
            key = [key[0].wrapping_add(0x9e37_79b9), key[1].wrapping_add(0xbb67_ae85)];
        }
        let of_a = u64::from(a) * 0xd251_1f53;
        let of_c = u64::from(c) * 0xcd9e_8d57;
        (a, b, c, d) = ((of_c >> 32) as u32 ^ b ^ key[0], of_c as u32, (of_a >> 32) as u32 ^ d ^ key[1], of_a as u32);
    }
    [a, b, c, d]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_philox::philox4x32_10;

    #[test]
    fn blocks_are_those_of_the_library() {
        let word = |k: u32, j: u32| (k + 1).wrapping_mul(0x9e37_79b9).rotate_left(7 * j) ^ j;
        for k in 0..100 {
            let (counter, key) = ([0, 1, 2, 3].map(|j| word(k, j)), [4, 5].map(|j| word(k, j)));
            assert_eq!(block(counter, key), philox4x32_10(counter, key));
        }
    }
}
