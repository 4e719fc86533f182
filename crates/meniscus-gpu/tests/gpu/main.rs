//! Plans on whatever adapter is there; without one the tests fail and say how to get one.

mod build;
mod drawing;
mod failing;
mod live;
mod moving;
mod passes;
mod skipping;
mod timing;
mod views;
