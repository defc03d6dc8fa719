//! The user's decisions about frames: which frame comes next, acceptance, rejection and comments,
//! one at a time or several together, and the doubts that the program raises first. It also takes
//! in suggestions and withdraws outdated ones. How a suggestion is made is not decided here.

mod doubt;
mod frames;
mod gallery;
mod proposals;
mod quality;
mod review;
