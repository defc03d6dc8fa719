//! Robust losses.

/// A loss ρ as a function of the residual z in sigmas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Loss {
    /// z²: optimal if all clicks are right.
    Squared,
    /// z² up to `k` sigmas, then linear (Huber 1964): the influence of a wrong name is bounded.
    Huber {
        /// Where the quadratic part ends, sigmas.
        k: f64,
    },
    /// c² ln(1 + (z/c)²): the influence of distant clicks decreases.
    Cauchy {
        /// Where the influence is largest, sigmas.
        c: f64,
    },
    /// z² / (1 + (z/c)²): distant clicks add a constant and have no influence (Geman and McClure,
    /// 1987).
    GemanMcClure {
        /// Where half of the constant c² is reached, sigmas.
        c: f64,
    },
}

impl Default for Loss {
    /// Huber at 3 sigmas: efficiency 99 % on clean clicks.
    fn default() -> Self {
        Self::Huber { k: 3.0 }
    }
}

impl Loss {
    /// The loss of z², and its derivative by z², which is the weight in iteratively reweighted
    /// least squares.
    pub fn evaluate(self, z_squared: f64) -> (f64, f64) {
        match self {
            Self::Squared => (z_squared, 1.0),
            Self::Huber { k } => {
                // 2 k z − k² continues z² with the same value and slope at z = k.
                if z_squared <= k * k {
                    (z_squared, 1.0)
                } else {
                    let z = z_squared.sqrt();
                    (2.0 * k * z - k * k, k / z)
                }
            }
            Self::Cauchy { c } => {
                let ratio = z_squared / (c * c);
                (c * c * ratio.ln_1p(), 1.0 / (1.0 + ratio))
            }
            Self::GemanMcClure { c } => {
                let share = 1.0 / (1.0 + z_squared / (c * c));
                (z_squared * share, share * share)
            }
        }
    }
}

/// A sum of losses. Logarithms are slow, so the arguments of Cauchy's logarithms are multiplied
/// first, up to the range of a number, and one logarithm is taken of the product.
#[derive(Clone, Copy, Debug)]
pub(super) struct LossSum {
    cost: f64,
    /// The product of 1 + (z/c)² that is not in `cost` yet.
    product: f64,
    c: f64,
}

impl LossSum {
    /// Nothing yet.
    pub const ZERO: Self = Self {
        cost: 0.0,
        product: 1.0,
        c: 1.0,
    };

    /// Adds the loss of z² sigmas²; returns its weight.
    #[inline]
    pub fn add(&mut self, z_squared: f64, loss: Loss) -> f64 {
        /// The logarithm is taken before the product grows beyond this.
        const LARGE: f64 = 1e200;
        let Loss::Cauchy { c } = loss else {
            let (cost, weight) = loss.evaluate(z_squared);
            self.cost += cost;
            return weight;
        };
        // Another scale: finish the product of the old one first.
        if self.c != c {
            *self = Self {
                cost: self.total(),
                product: 1.0,
                c,
            };
        }

        // Written so that a NaN is added to the cost at once.
        let factor = 1.0 + z_squared / (c * c);
        self.product *= factor;
        if !(self.product < LARGE) {
            *self = Self {
                cost: self.total(),
                product: 1.0,
                c,
            };
        }
        1.0 / factor
    }

    /// The sum.
    #[inline]
    pub fn total(&self) -> f64 {
        // A sum without a Cauchy loss needs no logarithm.
        if self.product == 1.0 {
            self.cost
        } else {
            self.cost + self.c * self.c * self.product.ln()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weight_is_the_derivative_of_the_loss() {
        for loss in [
            Loss::Squared,
            Loss::Huber { k: 2.0 },
            Loss::Cauchy { c: 2.4 },
            Loss::GemanMcClure { c: 2.1 },
        ] {
            for z_squared in [0.3, 3.9, 4.1, 50.0] {
                let h = 1e-6;
                let numeric =
                    (loss.evaluate(z_squared + h).0 - loss.evaluate(z_squared - h).0) / (2.0 * h);
                assert!(
                    (loss.evaluate(z_squared).1 - numeric).abs() < 1e-8,
                    "{loss:?} {z_squared}"
                );
            }
        }
    }

    #[test]
    fn a_sum_of_losses_is_their_sum_whatever_their_kind_and_number() {
        let kinds = [
            Loss::Cauchy { c: 3.0 },
            Loss::Squared,
            Loss::Cauchy { c: 1.5 },
            Loss::Huber { k: 3.0 },
            Loss::GemanMcClure { c: 2.0 },
        ];
        let (mut sum, mut expected) = (LossSum::ZERO, 0.0);
        for step in 0..4000u32 {
            let (z_squared, loss) = (
                f64::from(step % 97).powi(3),
                kinds[(step as usize / 7) % kinds.len()],
            );
            let (cost, weight) = loss.evaluate(z_squared);
            expected += cost;
            assert!((sum.add(z_squared, loss) - weight).abs() < 1e-15);
        }
        assert!(
            (sum.total() / expected - 1.0).abs() < 1e-12,
            "{} {expected}",
            sum.total()
        );
    }
}
