//! How likely the cameras of some pictures are by the paint that these show, as one number in nats.
//!
//! # Problem
//!
//! Given: a field, the cameras of one or more pictures, and the marking pixels of each. Wanted: the
//! logarithm of the likelihood of the marking pixels if the cameras are right, over that if no line
//! is where the cameras have one. It must say the same of a tennis court and of a soccer field, of
//! three pictures and of forty, so that hypotheses from any source can be put in one order.
//!
//! # Model
//!
//! 1. *Lines.* Each line is sampled evenly in the picture. Observed at a sample on open ground is
//!    the distance across the line to the nearest marking pixel of about its direction, or that
//!    there is none within reach. Both are likely in one way where paint is, and in another where
//!    none is; the latter is measured in the same picture, at places parallel to the lines. Hidden
//!    samples (players, graphics, what is no ground) say nothing.
//! 2. *Paint without lines.* Marking pixels on the field that no line explains are a clutter that
//!    right cameras leave little of.
//! 3. *One stretch, one vote.* Neighbouring samples see the same chalk, and so does every picture
//!    that shows it. So the samples of one stretch of a line, in all pictures, are averaged and
//!    count once, and so is the paint of one place of the ground.
//!
//! The sum is large for cameras that are right, near zero for cameras that see little, and negative
//! where lines lie on bare ground. A share, such as that of the lines with paint, cannot tell the
//! first two apart: a camera that has three lines in view and all of them on paint scores as high as
//! one with twenty.
//!
//! # Files
//!
//! `picture.rs` reads one picture with its camera, `nats.rs` weighs what was read.

mod nats;
mod picture;

pub use nats::Evidence;
