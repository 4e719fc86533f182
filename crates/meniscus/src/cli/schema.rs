//! `meniscus schema`

use meniscus::pipeline::SCHEMA;

use super::Failure;
use super::say::say;

pub(crate) fn run() -> Result<(), Failure> {
    say(SCHEMA)
}
