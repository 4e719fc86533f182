//! What the tests share: parsing, calling, and random numbers.

use meniscus_stress::{Lanes, Program, Resources, Scalar, Settings};

/// Compiles WGSL that is meant to be right.
pub fn program(source: &str) -> Program {
    program_with(source, Settings::default())
}

/// As [`program`], with settings.
pub fn program_with(source: &str, settings: Settings) -> Program {
    let module = match naga::front::wgsl::parse_str(source) {
        Ok(module) => module,
        Err(error) => panic!("{}", error.emit_to_string(source)),
    };
    let capabilities = naga::valid::Capabilities::all();
    let flags = naga::valid::ValidationFlags::all() - naga::valid::ValidationFlags::BINDINGS;
    let info = match naga::valid::Validator::new(flags, capabilities).validate(&module) {
        Ok(info) => info,
        Err(error) => panic!("{}", error.emit_to_string(source)),
    };
    Program::new(&module, &info, settings).expect("a program")
}

/// Calls a function that needs no resources.
#[allow(dead_code, reason = "not every test file calls plain functions")]
pub fn call<S: Scalar>(program: &Program, name: &str, arguments: &[Lanes<S>]) -> Lanes<S> {
    let lanes = arguments
        .first()
        .and_then(|a| a.columns.first())
        .map_or(1, |c| c.len());
    let function = program.function(name).unwrap_or_else(|e| panic!("{e}"));
    function
        .call(arguments, lanes, &Resources::new())
        .unwrap_or_else(|e| panic!("{e}"))
}

/// A small generator, so that runs are alike.
pub struct Chance(u64);

#[allow(dead_code, reason = "not every test file needs every distribution")]
impl Chance {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 32) as u32
    }

    /// In [low, high].
    pub fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.bits() as f32 / u32::MAX as f32)
    }

    /// Equally likely in every decade.
    pub fn log(&mut self, low: f32, high: f32) -> f32 {
        self.within(low.ln(), high.ln()).exp().clamp(low, high)
    }

    /// Any finite number, uniform in its bits.
    pub fn finite(&mut self) -> f32 {
        loop {
            let x = f32::from_bits(self.bits());
            if x.is_finite() {
                return x;
            }
        }
    }
}
