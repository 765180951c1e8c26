//! Choices among a finite number, in constant time.

use super::coordinate;
use super::piecewise::largest;
use crate::Error;

/// A choice among a finite number with given weights, in constant time.[^walker]
///
/// One coordinate chooses, and what is left of it is a coordinate again. A weight of zero is never chosen. Which
/// `u` belong to which choice has no order; [`Piecewise`](super::Piecewise) keeps the order, in logarithmic time.
///
/// ```
/// use estimand::warp::AliasTable;
///
/// let table = AliasTable::new(&[1.0, 0.0, 3.0])?;
/// assert_eq!(table.probability(2), 0.75);
/// assert_ne!(table.choose(0.4).index, 1);
/// # Ok::<(), estimand::Error>(())
/// ```
///
/// [^walker]: Walker, Alastair (1977). *An Efficient Method for Generating Discrete Random Variables with General
///     Distributions*. <https://doi.org/10.1145/355744.355749>; built in linear time as by Vose, Michael (1991). *A Linear
///     Algorithm for Generating Random Numbers with a Given Distribution*. <https://doi.org/10.1109/32.92917>
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AliasTable {
    bins: Vec<Bin>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Bin {
    probability: f64,
    /// Up to this share of the bin its own index is chosen, past it the alias.
    share: f64,
    alias: usize,
}

/// What an [`AliasTable`] chose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Which one.
    pub index: usize,
    /// A coordinate in `[0, 1)` to go on with, uniform whatever the choice.
    pub u: f64,
}

impl AliasTable {
    /// The table in which `index` has a probability proportional to `weights[index]`.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] for no weights, for a weight that is negative or not finite, and if all are zero.
    pub fn new(weights: &[f64]) -> Result<Self, Error> {
        let scale = largest(weights)?;
        let sum: f64 = weights.iter().map(|weight| weight / scale).sum();
        let mut bins: Vec<Bin> = weights
            .iter()
            .enumerate()
            .map(|(index, weight)| Bin {
                probability: weight / scale / sum,
                share: 1.0,
                alias: index,
            })
            .collect();
        let count = bins.len() as f64;
        let mut left: Vec<f64> = bins.iter().map(|bin| bin.probability * count).collect();
        let (mut poor, mut rich): (Vec<_>, Vec<_>) =
            (0..bins.len()).partition(|&index| left[index] < 1.0);
        while let (Some(&giver), Some(taker)) = (rich.last(), poor.pop()) {
            bins[taker].share = left[taker];
            bins[taker].alias = giver;
            left[giver] -= 1.0 - left[taker];
            if left[giver] < 1.0 {
                rich.pop();
                poor.push(giver);
            }
        }
        // What rounding has left without a partner is full but for that rounding; not so a weight of zero.
        if let Some(heaviest) = (0..bins.len()).find(|&index| weights[index] == scale) {
            for index in poor {
                if weights[index] == 0.0 {
                    bins[index].share = 0.0;
                    bins[index].alias = heaviest;
                }
            }
        }
        Ok(Self { bins })
    }

    /// The choice that `u` in `[0, 1)` makes.
    #[inline]
    pub fn choose(&self, u: f64) -> Choice {
        let scaled = u * self.bins.len() as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "below the number of bins"
        )]
        let index = (scaled as usize).min(self.bins.len() - 1);
        let within = scaled - index as f64;
        let Bin { share, alias, .. } = self.bins[index];
        if within < share {
            Choice {
                index,
                u: coordinate(within / share),
            }
        } else {
            Choice {
                index: alias,
                u: coordinate((within - share) / (1.0 - share)),
            }
        }
    }

    /// The probability of `index`.
    ///
    /// # Panics
    ///
    /// If there is no such index.
    pub fn probability(&self, index: usize) -> f64 {
        self.bins[index].probability
    }
}
