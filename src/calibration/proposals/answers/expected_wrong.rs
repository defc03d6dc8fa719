//! The expected number of wrong answers among several, from their confidences.

/// Probability outside of each end of the interval.
const TAIL: f64 = 0.025;

/// The distribution of the number of wrong answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedWrong {
    /// Its mean.
    pub mean: f64,
    /// Lower end of its 95 % interval.
    pub least: usize,
    /// Upper end of its 95 % interval.
    pub most: usize,
}

impl ExpectedWrong {
    /// Among answers of these confidences, which are right or wrong independently: the Poisson
    /// binomial distribution, computed exactly by the recursion P(k) ← P(k) (1 − q) + P(k − 1) q
    /// over the answers, with q the probability that an answer is wrong.
    pub fn among(confidences: impl IntoIterator<Item = f64>) -> Self {
        // Probability of each number of wrong answers among those so far.
        let mut of_count = vec![1.0];
        let mut mean = 0.0;
        for confidence in confidences {
            let wrong = 1.0 - confidence.clamp(0.0, 1.0);
            mean += wrong;
            of_count.push(0.0);
            // From the largest number down, so that P(k − 1) is still that without this answer.
            for count in (0..of_count.len()).rev() {
                let one_less = if count > 0 { of_count[count - 1] } else { 0.0 };
                of_count[count] = of_count[count] * (1.0 - wrong) + one_less * wrong;
            }
            // Drop the negligible tail; the time would otherwise grow with the square of the number
            // of answers.
            while of_count
                .last()
                .is_some_and(|probability| *probability < 1e-15)
                && of_count.len() > 1
            {
                of_count.pop();
            }
        }
        let mut sum = 0.0;
        let upto: Vec<f64> = of_count
            .iter()
            .map(|probability| {
                sum += probability;
                sum
            })
            .collect();
        Self {
            mean,
            least: quantile_of(&upto, TAIL),
            most: quantile_of(&upto, 1.0 - TAIL),
        }
    }
}

/// The quantile of a cumulative distribution over 0, 1, …: the first number at which it exceeds
/// `share`, or the last one.
fn quantile_of(cumulative: &[f64], share: f64) -> usize {
    cumulative
        .iter()
        .position(|upto| *upto > share)
        .unwrap_or(cumulative.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::ExpectedWrong;

    #[test]
    fn few_doubtful_among_many_certain_are_counted_exactly() {
        let none = ExpectedWrong::among([]);
        assert_eq!((none.mean, none.least, none.most), (0.0, 0, 0));
        // Ten coins: at most 8 and at least 2 with 97.9 % each.
        let coins = ExpectedWrong::among([0.5; 10]);
        assert_eq!((coins.mean, coins.least, coins.most), (5.0, 2, 8));
        let certain = ExpectedWrong::among([1.0; 500].into_iter().chain([0.0; 3]));
        assert_eq!((certain.mean, certain.least, certain.most), (3.0, 3, 3));
    }

    #[test]
    fn of_many_it_is_about_a_poisson_distribution() {
        let many = ExpectedWrong::among(std::iter::repeat_n(0.999, 10_000));
        assert!(
            (many.mean - 10.0).abs() < 1e-9 && (many.least, many.most) == (4, 17),
            "{many:?}"
        );
    }
}
