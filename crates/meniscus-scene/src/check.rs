//! What must hold of every scene.

use meniscus_source::{Diagnostic, Report};

use crate::Scene;
use crate::soup::is_proper;

impl Scene {
    /// Checks what the types cannot promise: everything finite, indices in range, unit normals,
    /// no degenerate triangle, an eye that looks somewhere.
    ///
    /// # Errors
    /// One message for each rule that is broken, naming the first place where it is.
    pub fn check(&self) -> Result<(), Report> {
        let mut report = Report::default();
        let mut broken =
            |what: String| report.add(Diagnostic::error(format!("scene `{}`: {what}", self.name)));
        let mesh = &self.mesh;
        if mesh.normals.len() != mesh.positions.len() {
            broken(format!(
                "{} normals for {} vertices",
                mesh.normals.len(),
                mesh.positions.len()
            ));
        }
        if let Some(index) = mesh.positions.iter().position(|p| !p.is_finite()) {
            broken(format!("vertex {index} is not finite"));
        }
        if let Some(index) = mesh
            .normals
            .iter()
            .position(|n| (n.length() - 1.0).abs() > 1e-5 || !n.is_finite())
        {
            broken(format!("the normal of vertex {index} is not a unit vector"));
        }
        let outside = |index: u32| index as usize >= mesh.positions.len();
        if let Some(index) = mesh
            .triangles
            .iter()
            .position(|t| t.corners.into_iter().any(outside))
        {
            broken(format!("triangle {index} names a vertex that there isn't"));
        } else if let Some(index) = (0..mesh.triangles.len()).find(|&t| !is_proper(mesh.corners(t)))
        {
            broken(format!("triangle {index} has no area"));
        }
        if let Some(index) = mesh
            .triangles
            .iter()
            .position(|t| t.object as usize >= self.objects.len())
        {
            broken(format!(
                "triangle {index} belongs to an object that there isn't"
            ));
        }
        if let Some(object) = self
            .objects
            .iter()
            .find(|o| o.material as usize >= self.materials.len())
        {
            broken(format!(
                "object `{}` has a material that there isn't",
                object.name
            ));
        }
        let camera = &self.camera;
        let look = camera.target - camera.eye;
        if !(look.is_finite() && look.length() > 0.0) {
            broken("the eye looks nowhere".into());
        }
        let numbers = [
            camera.field_of_view,
            camera.near,
            self.water.level,
            self.water.refractive_index,
            self.water.time,
        ];
        let terms = self.water.waves.iter().flat_map(|wave| {
            [
                wave.amplitude,
                wave.wave_vector.x,
                wave.wave_vector.y,
                wave.angular_frequency,
                wave.phase,
            ]
        });
        if numbers
            .into_iter()
            .chain(terms)
            .any(|number| !number.is_finite())
        {
            broken("a number of the camera or the water is not finite".into());
        }
        if !self.moving.is_empty() && self.moving.time() != self.water.time {
            broken(format!(
                "its objects stand as at {} s, its water as at {} s",
                self.moving.time(),
                self.water.time
            ));
        }
        if !self.sun.direction.is_normalized() {
            broken("the sun's direction is not a unit vector".into());
        }
        report.into_result(())
    }
}
