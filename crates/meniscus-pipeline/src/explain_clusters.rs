//! What of each draw is left out because it is out of view.

use meniscus_scene::{Clusters, Scene, WaterBand, WaterGeometry};
use serde::Serialize;

use crate::cull::{Appears, Cull};
use crate::explain::Explanation;
use crate::outlook::WIDEST;
use crate::plan::{Geometry, PassKind, PlannedPass, Size};
use crate::rules::Rule;

/// Clusters of triangles that a pass would draw if nothing were left out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ClustersSaid {
    /// How many there are.
    pub clusters: u64,
    /// How many of them are not drawn, at least: a guard band may be narrower than is assumed here.
    pub dropped: u64,
    /// Triangles of those.
    pub triangles: u64,
    /// By which rule.
    pub rule: &'static str,
    /// What it says.
    pub says: &'static str,
    /// Where points appear that the pass draws; none where its modules do not say.
    pub appears: Option<&'static str>,
}

/// A pass that draws triangles.
#[derive(Debug, Clone)]
pub(crate) struct Drawing {
    pass: String,
    geometry: Geometry,
    view: Size,
    appears: Option<Appears>,
}

impl Drawing {
    pub fn of(pass: &PlannedPass) -> Option<Self> {
        match pass.kind {
            PassKind::Draw(geometry) => Some(Self {
                pass: pass.name.clone(),
                geometry,
                view: pass.view_target,
                appears: pass.appears,
            }),
            _ => None,
        }
    }
}

impl Explanation {
    /// The same with what each pass need not draw of the scene, which is the one that the outlook is
    /// of, because it is out of view.
    #[must_use]
    pub fn with_clusters(mut self, scene: &Scene) -> Self {
        let all = Clusters::new(&scene.mesh, WaterBand::of(scene));
        let water = &scene.water;
        let waves = match water.geometry {
            WaterGeometry::Flat => 0.0,
            WaterGeometry::Displaced => water.height(scene.camera.eye.truncate()),
        };
        let above = scene.camera.eye.z >= water.level + waves;
        for drawing in &self.drawings {
            let mut view = scene.camera.view(self.size.into());
            if drawing.view == Size::Guarded {
                view.size = (WIDEST * view.size.as_dvec2()).ceil().as_uvec2();
            }
            let cull = drawing
                .appears
                .map(|appears| Cull::new(&view, water, above, appears));
            let range = match (drawing.geometry, above) {
                (Geometry::All, _) => 0..all.below.end,
                (Geometry::NearSide, true) | (Geometry::FarSide, false) => all.above.clone(),
                (Geometry::NearSide, false) | (Geometry::FarSide, true) => all.below.clone(),
            };
            let mut said = ClustersSaid {
                clusters: 0,
                dropped: 0,
                triangles: 0,
                rule: Rule::OutOfView.name(),
                says: Rule::OutOfView.says(),
                appears: drawing.appears.map(Appears::words),
            };
            let within = |triangle: &u32| range.contains(triangle);
            for cluster in all.clusters.iter().filter(|c| within(&c.triangles.start)) {
                said.clusters += 1;
                if cull.is_some_and(|cull| cull.misses(cluster.low, cluster.high)) {
                    said.dropped += 1;
                    said.triangles += cluster.triangles.len() as u64;
                }
            }
            if let Some(pass) = self.passes.iter_mut().find(|p| p.name == drawing.pass) {
                pass.clusters = Some(said);
            }
        }
        self
    }
}
