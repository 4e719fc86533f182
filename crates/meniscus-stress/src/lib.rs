//! Runs module functions on the CPU in several number systems and hunts their worst inputs.
