//! A scene on its way to being written down.

use std::fmt::Write as _;

/// What a scene file is written from: lengths in metres, angles in degrees.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Draft {
    pub position: [f64; 2],
    /// Of the eye above the rest plane, or above the waves where `rides`.
    pub height: f64,
    pub rides: bool,
    pub target: [f64; 3],
    pub field_of_view: f64,
    pub near: f64,
    pub sun: Light,
    pub water: WaterDraft,
    pub objects: Vec<String>,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct WaterDraft {
    pub level: f64,
    pub index: f64,
    pub slope: f64,
    pub time: f64,
    pub displaced: bool,
    /// Direction, wavelength, weight and phase.
    pub waves: Vec<[f64; 4]>,
}

/// Of the sun and the sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Light {
    pub elevation: f64,
    /// Factor of all colours.
    pub strength: f64,
}

impl Draft {
    /// A small pool with a ball under water and a box above it, of few triangles.
    pub fn pool(random: &mut fastrand::Rng) -> Self {
        let mut between = |low: f64, high: f64| low + (high - low) * random.f64();
        let wave = |i: u32, between: &mut dyn FnMut(f64, f64) -> f64| {
            let direction = 137.5 * f64::from(i) % 360.0;
            [
                direction,
                between(0.5, 2.0),
                between(0.2, 1.0),
                between(0.0, 360.0),
            ]
        };
        let position = [between(-1.5, 1.5), between(-3.0, -1.5)];
        let height = between(0.8, 2.5);
        let target = [between(-0.5, 0.5), between(0.2, 1.0), between(-1.0, -0.3)];
        let slope = between(0.0, 0.2);
        let waves = (0..3).map(|i| wave(i, &mut between)).collect();
        let field_of_view = between(35.0, 70.0);
        let time = between(0.0, 10.0);
        let displaced = random.bool();
        Self {
            position,
            height,
            rides: false,
            target,
            field_of_view,
            near: 0.05,
            sun: Light {
                elevation: 45.0,
                strength: 1.0,
            },
            water: WaterDraft {
                level: 0.0,
                index: 1.333,
                slope,
                time,
                displaced,
                waves,
            },
            objects: vec![
                object("basin", "Pool(size: (6, 4), depth: 2, rise: 0.1), edge: 1"),
                object(
                    "ball",
                    "Sphere(radius: 0.4), edge: 0.2, translate: (0.3, 0.6, -1.2)",
                ),
                object(
                    "crate",
                    "Box(size: (0.5, 0.4, 0.6)), edge: 0.3, translate: (-0.7, 0.9, 0.1)",
                ),
            ],
            size: [24, 16],
        }
    }

    /// The scene file.
    pub fn ron(&self, about: &str) -> String {
        let mut text = format!("// {about}\nScene(\n    about: \"An extreme scene.\",\n");
        let [x, y] = self.position;
        let [tx, ty, tz] = self.target;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "    camera: (position: ({x:?}, {y:?}), height: {:?}, target: ({tx:?}, {ty:?}, {tz:?}), \
             field_of_view: {:?}, near: {:?}),",
            self.height, self.field_of_view, self.near
        );
        let Light {
            elevation,
            strength,
        } = self.sun;
        let colour = |[r, g, b]: [f64; 3]| {
            format!(
                "({:?}, {:?}, {:?})",
                r * strength,
                g * strength,
                b * strength
            )
        };
        let _ = writeln!(
            text,
            "    sun: (elevation: {elevation:?}, colour: {}, ambient: {}),",
            colour([0.9, 0.8, 0.7]),
            colour([0.3, 0.3, 0.4])
        );
        let _ = writeln!(
            text,
            "    sky: (horizon: {}, zenith: {}, deep: {}),",
            colour([0.7, 0.8, 0.9]),
            colour([0.2, 0.4, 0.7]),
            colour([0.0, 0.1, 0.1])
        );
        let water = &self.water;
        let geometry = if water.displaced { "Displaced" } else { "Flat" };
        let _ = writeln!(
            text,
            "    water: (level: {:?}, refractive_index: {:?}, rms_slope: {:?}, time: {:?}, \
             geometry: {geometry}, waves: [",
            water.level, water.index, water.slope, water.time
        );
        for [direction, wavelength, weight, phase] in &water.waves {
            let _ = writeln!(
                text,
                "        (direction: {direction:?}, wavelength: {wavelength:?}, weight: {weight:?}, \
                 phase: {phase:?}),"
            );
        }
        text += "    ]),\n    materials: { \"tiles\": (colour: (0.2, 0.5, 0.6), tiles: \
                 (size: 0.5, line: 0.03, offset: 0.087, colour: (0.7, 0.8, 0.8))) },\n    objects: [\n";
        for object in &self.objects {
            let _ = writeln!(text, "        {object},");
        }
        text + "    ],\n)\n"
    }
}

/// An object with a shape, and what may follow the shape.
pub(crate) fn object(name: &str, shape: &str) -> String {
    format!("(name: \"{name}\", material: \"tiles\", shape: {shape})")
}
