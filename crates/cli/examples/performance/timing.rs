//! Repeated, interleaved timing, with its spread.

use std::time::Instant;

use crate::Outcome;

/// What repeats of one work gave, in the order in which they ran: seconds, or ratios of them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Times(pub(crate) Vec<f64>);

impl Times {
    /// The middle one; of an even number the mean of the middle two.
    pub(crate) fn median(&self) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        if n == 0 { f64::NAN } else { 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]) }
    }

    /// The least and the greatest.
    pub(crate) fn range(&self) -> (f64, f64) {
        self.0.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &t| (low.min(t), high.max(t)))
    }

    /// Each over that of the same round: what slows the machine down for a while slows both.
    pub(crate) fn over(&self, other: &Self) -> Self {
        Self(self.0.iter().zip(&other.0).map(|(a, b)| a / b).collect())
    }

    /// Each over the same number.
    pub(crate) fn over_number(&self, number: f64) -> Self {
        Self(self.0.iter().map(|a| a / number).collect())
    }

    /// The median, with the least and greatest where they differ.
    pub(crate) fn shown(&self) -> String {
        let (low, high) = self.range();
        let median = seconds(self.median());
        if low < high { format!("{median} ({} to {})", seconds(low), seconds(high)) } else { median }
    }
}

/// Three digits of a time.
pub(crate) fn seconds(time: f64) -> String {
    if time < 1.0 { format!("{} ms", digits(1e3 * time)) } else { format!("{} s", digits(time)) }
}

/// Three digits, more only before the point.
pub(crate) fn digits(number: f64) -> String {
    match number.abs() {
        n if n < 0.995 => format!("{number:.3}"),
        n if n < 9.95 => format!("{number:.2}"),
        n if n < 99.5 => format!("{number:.1}"),
        _ => format!("{number:.0}"),
    }
}

/// One work: does it once and gives the seconds that count.
pub(crate) type Work<'a> = &'a mut dyn FnMut() -> Outcome<f64>;

/// `rounds` rounds of all works in turn; the times of each.
pub(crate) fn interleaved<const N: usize>(rounds: usize, works: [Work<'_>; N]) -> Outcome<[Times; N]> {
    let mut times = [const { Times(Vec::new()) }; N];
    let mut works = works;
    for _ in 0..rounds {
        for (work, times) in works.iter_mut().zip(&mut times) {
            times.0.push(work()?);
        }
    }
    Ok(times)
}

/// How long `work` takes, and what it made; taking that apart again is not timed.
pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let made = std::hint::black_box(work());
    (made, start.elapsed().as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_and_ranges() {
        assert_eq!(Times(vec![3.0, 1.0, 2.0]).median(), 2.0);
        assert_eq!(Times(vec![4.0, 1.0, 2.0, 3.0]).median(), 2.5);
        assert_eq!(Times(vec![3.0, 1.0, 2.0]).range(), (1.0, 3.0));
        assert!(Times(vec![]).median().is_nan());
    }

    #[test]
    fn ratios_are_those_of_rounds() {
        let ratio = Times(vec![2.0, 20.0]).over(&Times(vec![1.0, 10.0]));
        assert_eq!(ratio, Times(vec![2.0, 2.0]));
    }

    #[test]
    fn works_take_turns() {
        let order = std::cell::RefCell::new(String::new());
        let mut a = || {
            order.borrow_mut().push('a');
            Ok(1.0)
        };
        let mut b = || {
            order.borrow_mut().push('b');
            Ok(2.0)
        };
        let [first, second] = interleaved(3, [&mut a, &mut b]).expect("no work fails");
        assert_eq!((first, second), (Times(vec![1.0; 3]), Times(vec![2.0; 3])));
        assert_eq!(order.into_inner(), "ababab");
    }

    #[test]
    fn three_digits() {
        assert_eq!([0.0123, 0.9999, 9.96, 123.4].map(digits), ["0.012", "1.00", "10.0", "123"]);
        assert_eq!([0.0123, 2.5].map(seconds), ["12.3 ms", "2.50 s"]);
    }
}
