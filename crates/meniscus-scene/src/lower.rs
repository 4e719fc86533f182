//! From a scene file to a scene.

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3, EulerRot, Vec3};
use meniscus_source::ron::Spanned;
use meniscus_source::{Diagnostic, Report, SourceFile};

use crate::description::{
    Document, GeometryFile, MaterialFile, MotionFile, Number, ObjectFile, Pair, SceneFile, Triple,
    WaterFile,
};
use crate::generate::{Source, source};
use crate::motion::{Body, FARTHEST};
use crate::settings::{self, Setting, located, start_of, within};
use crate::soup::{MOST_TRIANGLES, Soup};
use crate::{
    Camera, Material, Mesh, Motion, Moving, Object, Pattern, Scene, Sky, Sun, Water, WaterGeometry,
    Wave,
};

/// Standard acceleration of gravity, m/s².
const GRAVITY: f64 = 9.806_65;

/// Cells of a scene without a budget, metres: straight edges bow little through water.
const USUAL_EDGE: f64 = 0.15;

impl Scene {
    /// Makes a scene of what a file says. Mesh files are searched from `base_dir`; without one,
    /// as for texts in the program itself, there are none.
    ///
    /// # Errors
    /// Every fault found in the file, in the settings and in mesh files, with its place.
    pub fn load(
        file: &Arc<SourceFile>,
        base_dir: Option<&Path>,
        settings: &[Setting],
    ) -> Result<Self, Report> {
        let mut described = match Document::read(file)? {
            Document::Scene(scene) => *scene,
            Document::Variant(variant) => {
                let message = "a variant of another scene is loaded from a library of scenes";
                return Err(located(Diagnostic::error(message), &variant.of.place).into());
            }
        };
        let mut report = settings::apply(&mut described, settings);
        report.extend(settings::check(&mut described));
        if !report.is_ok() {
            return Err(report);
        }
        let mut reader = Reader { report };
        let scene = reader.scene(file, &described, base_dir);
        reader.report.into_result(scene)?.ok_or_else(|| {
            Diagnostic::error("the scene has no triangles")
                .at(&start_of(file), "")
                .into()
        })
    }
}

/// Turns written values into meant ones and gathers what is wrong with them.
pub(crate) struct Reader {
    pub report: Report,
}

impl Reader {
    /// A number in its range; out of it, a message and `least`.
    pub fn number(&mut self, name: &str, number: &Number, least: f64, most: f64) -> f64 {
        within(name, number, least, most).unwrap_or_else(|diagnostic| {
            self.report.add(diagnostic);
            least
        })
    }

    /// A length that is not zero, metres.
    pub fn length(&mut self, name: &str, number: &Number) -> f64 {
        self.number(name, number, 1e-4, 1e5)
    }

    /// Two lengths.
    pub fn lengths(&mut self, name: &str, (x, y): &Pair) -> DVec2 {
        DVec2::new(self.length(name, x), self.length(name, y))
    }

    fn triple(&mut self, name: &str, (x, y, z): &Triple, least: f64, most: f64) -> DVec3 {
        DVec3::new(
            self.number(name, x, least, most),
            self.number(name, y, least, most),
            self.number(name, z, least, most),
        )
    }

    /// Three lengths.
    pub fn size(&mut self, name: &str, triple: &Triple) -> DVec3 {
        self.triple(name, triple, 1e-4, 1e5)
    }

    fn light(&mut self, name: &str, triple: &Triple) -> Vec3 {
        self.triple(name, triple, 0.0, 1e3).as_vec3()
    }

    fn albedo(&mut self, name: &str, triple: &Triple) -> Vec3 {
        self.triple(name, triple, 0.0, 1.0).as_vec3()
    }

    fn scene(
        &mut self,
        file: &Arc<SourceFile>,
        described: &SceneFile,
        base_dir: Option<&Path>,
    ) -> Option<Scene> {
        let water = self.water(&described.water);
        let camera = self.camera(described, water.level);
        let sun = &described.sun;
        let (azimuth, elevation) = (sun.azimuth.to_radians(), sun.elevation.to_radians());
        let sun = Sun {
            direction: (DVec2::from_angle(azimuth) * elevation.cos())
                .extend(elevation.sin())
                .normalize(),
            colour: self.light("sun.colour", &sun.colour),
            ambient: self.light("sun.ambient", &sun.ambient),
        };
        let sky = Sky {
            horizon: self.light("sky.horizon", &described.sky.horizon),
            zenith: self.light("sky.zenith", &described.sky.zenith),
            deep: self.light("sky.deep", &described.sky.deep),
        };
        let materials: Vec<Material> = described
            .materials
            .iter()
            .map(|(_, material)| self.material(material))
            .collect();
        let names: Vec<&str> = described
            .materials
            .iter()
            .map(|(name, _)| name.as_str())
            .collect();
        let objects = self.objects(described, &names);
        let (mesh, moving) = self.mesh(described, base_dir, &water);
        if !self.report.is_ok() || mesh.triangles.is_empty() {
            return None;
        }
        Some(Scene {
            name: stem(&file.name),
            about: described.about.clone(),
            objects,
            materials,
            mesh,
            moving,
            water,
            camera,
            sun,
            sky,
        })
    }

    fn camera(&mut self, described: &SceneFile, level: f64) -> Camera {
        // All of these are settings, whose ranges have been checked.
        let camera = &described.camera;
        let (x, y, z) = &camera.target;
        let eye = DVec3::new(
            camera.position.0.value,
            camera.position.1.value,
            level + camera.height.value,
        );
        let target = DVec3::new(x.value, y.value, z.value);
        if (target - eye).length() < 1e-6 {
            let message = "the camera stands where it looks at";
            self.report.add(
                located(Diagnostic::error(message), &x.place)
                    .with_help("camera.position and camera.height say where the eye is; move camera.target away from it"),
            );
        }
        Camera {
            eye,
            target,
            field_of_view: camera.field_of_view.to_radians(),
            near: camera.near.value,
        }
    }

    fn water(&mut self, described: &WaterFile) -> Water {
        let mut waves = Vec::new();
        for wave in &described.waves {
            let wavelength = self.number("wavelength", &wave.wavelength, 1e-3, 1e4);
            let direction = self.number("direction", &wave.direction, -360.0, 360.0);
            let number = std::f64::consts::TAU / wavelength;
            let angular_frequency = match &wave.angular_frequency {
                Some(given) => self.number("angular_frequency", given, -1e4, 1e4),
                None => (GRAVITY * number).sqrt(),
            };
            waves.push(Wave {
                amplitude: self.number("weight", &wave.weight, 0.0, 1e3),
                wave_vector: DVec2::from_angle(direction.to_radians()) * number,
                angular_frequency,
                phase: self.number("phase", &wave.phase, -1e6, 1e6).to_radians(),
            });
        }
        let mut water = Water {
            // To the nearest f32, so that vertices can lie on it exactly.
            level: f64::from(described.level.value as f32),
            refractive_index: described.refractive_index.value,
            waves,
            time: described.time.value,
            geometry: match described.geometry.value {
                GeometryFile::Flat => WaterGeometry::Flat,
                GeometryFile::Displaced => WaterGeometry::Displaced,
            },
        };
        // The weights stand as amplitudes until here.
        let (wanted, weighted) = (described.rms_slope.value, water.rms_slope());
        if wanted > 0.0 && weighted == 0.0 {
            let message = format!("`water.rms_slope` is {wanted}, but there are no waves to scale");
            self.report.add(
                located(Diagnostic::error(message), &described.rms_slope.place)
                    .with_help("list waves in the scene file, such as (direction: 20, wavelength: 1.5), or set it to 0"),
            );
        }
        let factor = if weighted > 0.0 {
            wanted / weighted
        } else {
            0.0
        };
        for wave in &mut water.waves {
            wave.amplitude *= factor;
        }
        water
    }

    fn material(&mut self, described: &MaterialFile) -> Material {
        let colour = self.albedo("colour", &described.colour);
        let pattern = described.tiles.as_ref().map_or(Pattern::Plain, |tiles| {
            let size = self.number("size", &tiles.size, 1e-3, 1e4);
            Pattern::Tiles {
                size: size as f32,
                line: self.number("line", &tiles.line, 0.0, size) as f32,
                offset: self.number("offset", &tiles.offset, -1e4, 1e4) as f32,
                line_colour: self.albedo("colour", &tiles.colour),
            }
        });
        Material { colour, pattern }
    }

    fn objects(&mut self, described: &SceneFile, materials: &[&str]) -> Vec<Object> {
        let mut objects: Vec<Object> = Vec::new();
        for object in &described.objects {
            let name = &object.name;
            if objects.iter().any(|known| known.name == name.value) {
                let message = format!("there are two objects called `{}`", name.value);
                self.report.add(
                    located(Diagnostic::error(message), &name.place)
                        .with_help("give each its own name"),
                );
            }
            let material = materials.iter().position(|&m| m == object.material.value);
            if material.is_none() {
                let message = format!("unknown material `{}`", object.material.value);
                self.report.add(
                    located(Diagnostic::error(message), &object.material.place)
                        .with_suggestion(&object.material.value, materials.iter().copied()),
                );
            }
            objects.push(Object {
                name: name.value.clone(),
                material: material.unwrap_or(0) as u32,
            });
        }
        objects
    }

    fn mesh(
        &mut self,
        described: &SceneFile,
        base_dir: Option<&Path>,
        water: &Water,
    ) -> (Mesh, Moving) {
        let level = water.level;
        let mut parts = Vec::new();
        for object in &described.objects {
            let place = self.place(object);
            // Upright shapes alone have rows that can run along the water.
            let upright = object.rotate.0.value == 0.0 && object.rotate.1.value == 0.0;
            let water = (upright && object.waterline)
                .then(|| (level - place.translation.z) / place.matrix3.z_axis.z);
            let source = source(self, object, base_dir);
            let detail = self.number("detail", &object.detail, 1e-3, 1e3);
            let edge = object.edge.as_ref().map(|edge| self.length("edge", edge));
            let motion = object.motion.as_ref().map(|motion| self.motion(motion));
            parts.push(Part {
                object,
                place,
                water,
                source,
                detail,
                edge,
                motion: motion.filter(|motion| !motion.is_still()),
            });
        }
        let mut mesh = Mesh::default();
        if !self.report.is_ok() {
            return (mesh, Moving::default());
        }
        let budget = described.pool.triangles.as_ref().map(|count| count.value.0);
        let edge = budget.map_or(USUAL_EDGE, |budget| edge_for(&parts, budget));
        let total: u64 = parts.iter().map(|part| part.triangles(edge)).sum();
        if total > MOST_TRIANGLES {
            let most = parts.iter().max_by_key(|part| part.triangles(edge));
            let message = format!(
                "the scene would have {total} triangles; at most {MOST_TRIANGLES} are made"
            );
            let place = most.and_then(|part| part.object.shape.place.clone());
            self.report.add(
                located(Diagnostic::error(message), &place)
                    .with_help("make `edge` larger or `detail` smaller; this object has the most"),
            );
            return (mesh, Moving::default());
        }
        let mut bodies = Vec::new();
        for (id, part) in parts.iter().enumerate() {
            let first = mesh.positions.len() as u32;
            let soup = part.soup(edge);
            let added = soup.append(&mut mesh, part.place, level, id as u32);
            if let Some(motion) = part.motion {
                let vertices = (first..mesh.positions.len() as u32).collect();
                let (positions, normals) = soup.placed(part.place).unzip();
                let motion = (motion, part.place.translation);
                bodies.push(Body::new(id as u32, motion, vertices, positions, normals));
            }
            if added == 0 {
                let message = format!("`{}` has no triangle with an area", part.object.name.value);
                self.report.add(located(
                    Diagnostic::error(message),
                    &part.object.shape.place,
                ));
            }
        }
        let mut moving = Moving::new(bodies);
        moving.set_time(&mut mesh, level, water.time);
        if let Some(far) = mesh
            .positions
            .iter()
            .position(|p| !p.is_finite() || p.abs().max_element() > FARTHEST as f32)
        {
            let owner = mesh
                .triangles
                .iter()
                .find(|t| t.corners.contains(&(far as u32)));
            let object = owner
                .and_then(|t| parts.get(t.object as usize))
                .map(|part| part.object);
            let message = format!("an object reaches further than {FARTHEST} m from the origin");
            let mut diagnostic = Diagnostic::error(message);
            if object.is_some_and(|o| o.motion.is_some()) {
                diagnostic = diagnostic.with_help(format!(
                    "it moves: this is where it is at {} s (water.time)",
                    water.time
                ));
            }
            self.report.add(located(
                diagnostic,
                &object.and_then(|o| o.name.place.clone()),
            ));
        }
        (mesh, moving)
    }

    fn motion(&mut self, described: &MotionFile) -> Motion {
        let turn = self.triple("turn", &described.turn, -1e4, 1e4);
        let (heave, period) = match &described.heave {
            Some(heave) => (
                self.number("amplitude", &heave.amplitude, 0.0, 1e4),
                self.number("period", &heave.period, 1e-2, 1e5),
            ),
            None => (0.0, 1.0),
        };
        Motion {
            velocity: self.triple("velocity", &described.velocity, -1e3, 1e3),
            turn: turn.map(f64::to_radians),
            heave,
            period,
        }
    }

    fn place(&mut self, object: &Spanned<ObjectFile>) -> DAffine3 {
        let degrees = self.triple("rotate", &object.rotate, -1e4, 1e4);
        let angles = degrees.map(f64::to_radians);
        let turn = DQuat::from_euler(EulerRot::ZYX, angles.z, angles.y, angles.x);
        let scale = self.triple("scale", &object.scale, 1e-6, 1e6);
        DAffine3 {
            matrix3: DMat3::from_quat(turn) * DMat3::from_diagonal(scale),
            translation: self.triple("translate", &object.translate, -FARTHEST, FARTHEST),
        }
    }
}

/// An object on its way to becoming triangles.
struct Part<'a> {
    object: &'a Spanned<ObjectFile>,
    place: DAffine3,
    /// z of the water in the shape's own space.
    water: Option<f64>,
    source: Source,
    detail: f64,
    edge: Option<f64>,
    /// None where it is static.
    motion: Option<Motion>,
}

impl Part<'_> {
    /// Longest cell side in the shape's own space for the budget's edge in the scene's.
    fn own_edge(&self, edge: f64) -> f64 {
        let stretch = self
            .place
            .matrix3
            .to_cols_array_2d()
            .map(|c| DVec3::from_array(c).length());
        let largest = stretch.into_iter().fold(0.0, f64::max);
        self.edge.unwrap_or(edge / self.detail) / largest
    }

    fn triangles(&self, edge: f64) -> u64 {
        match &self.source {
            Source::Given(soup) => soup.triangles.len() as u64,
            Source::Made(make) => make(self.own_edge(edge), self.water)
                .iter()
                .map(crate::shapes::Patch::triangles)
                .sum(),
        }
    }

    fn soup(&self, edge: f64) -> std::borrow::Cow<'_, Soup> {
        match &self.source {
            Source::Given(soup) => std::borrow::Cow::Borrowed(soup),
            Source::Made(make) => {
                std::borrow::Cow::Owned(Soup::from_patches(&make(self.own_edge(edge), self.water)))
            }
        }
    }
}

/// The edge with which the parts come nearest to a number of triangles.
fn edge_for(parts: &[Part<'_>], budget: f64) -> f64 {
    let miss =
        |edge: f64| parts.iter().map(|part| part.triangles(edge)).sum::<u64>() as f64 - budget;
    // Counts fall with the edge, in steps: halve in logarithms until steps are all that is left.
    let (mut fine, mut coarse) = (1e-4_f64.ln(), 1e3_f64.ln());
    for _ in 0..40 {
        let middle = 0.5 * (fine + coarse);
        if miss(middle.exp()) > 0.0 {
            fine = middle;
        } else {
            coarse = middle;
        }
    }
    let (fine, coarse) = (fine.exp(), coarse.exp());
    if miss(fine).abs() < miss(coarse).abs() {
        fine
    } else {
        coarse
    }
}

/// A file's name without folders and extension.
pub(crate) fn stem(path: &str) -> String {
    let leaf = path.rsplit(['/', '\\']).next().unwrap_or(path);
    leaf.strip_suffix(".ron").unwrap_or(leaf).to_owned()
}
