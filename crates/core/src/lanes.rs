//! Numbers of some points side by side, in loops that a compiler makes one instruction of.

/// How many points are looked at side by side: more would often be left over.
pub(crate) const LANES: usize = 4;

/// A number for each of them.
pub(crate) type Lanes = [f64; LANES];

/// Numbers from 0 up and below 2^31, rounded down.
#[inline]
pub(crate) fn floor(numbers: &Lanes) -> [i32; LANES] {
    // From here on doubles are whole numbers, whose lower bits are the lower half of the double. A conversion is slower,
    // because it sees to numbers out of range, one by one.
    const WHOLE: f64 = (1_u64 << 52) as f64;
    let mut floors = [0; LANES];
    for lane in 0..LANES {
        let near = (numbers[lane] + WHOLE) - WHOLE;
        let above = if near > numbers[lane] { 1.0 } else { 0.0 };
        floors[lane] = (near - above + WHOLE).to_bits() as i32;
    }
    floors
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn floors_are_those_of_conversions(x in 0.0..2_147_483_647.0_f64, whole in 0..i32::MAX, small in 0.0..1.0_f64) {
            let whole = f64::from(whole);
            let numbers = [x, whole, whole.next_down().max(0.0), small];
            prop_assert_eq!(floor(&numbers), numbers.map(|x| x as i32));
        }
    }
}
