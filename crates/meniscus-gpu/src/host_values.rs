//! What the host gives to a scene's shaders, as bytes and without a GPU.

use glam::UVec2;
use meniscus_pipeline::{PlannedPass, Size};
use meniscus_scene::Scene;
use meniscus_shader::{Binding, BindingKind};

use crate::host_scene::{HostScene, PassViews};
use crate::scene_arrays::SceneArrays;
use crate::{host_buffers, scene_buffers};

/// A scene's uniform blocks and arrays, for whoever runs passes elsewhere than on a GPU. A [`Frame`]
/// of the same scene and size uploads the same bytes.
///
/// [`Frame`]: crate::Frame
#[derive(Debug)]
pub struct HostValues {
    scene: HostScene,
    arrays: SceneArrays,
    heights: [f64; 2],
    size: UVec2,
}

impl HostValues {
    /// Of a scene with a proper mesh, in a frame of `size` pixels.
    pub fn new(scene: &Scene, size: UVec2) -> Self {
        Self {
            scene: HostScene::new(scene),
            arrays: SceneArrays::new(scene),
            heights: scene_buffers::heights(scene),
            size,
        }
    }

    /// Width and height of a view, pixels.
    pub fn view_size(&self, size: Size) -> UVec2 {
        self.scene.views(self.size, self.heights).size(size)
    }

    /// The bytes of a uniform block or array, in the layout that the pass's shader declares.
    ///
    /// # Errors
    /// When the host has nothing of that name, or not with these members.
    pub fn bytes(&self, pass: &PlannedPass, binding: &Binding) -> Result<Vec<u8>, String> {
        let (BindingKind::Uniform(ty) | BindingKind::Storage { ty, .. }) = binding.kind else {
            return Err("which is no buffer".to_owned());
        };
        let resource = binding.resource.as_str();
        if SceneArrays::has(resource) {
            return self.arrays.laid_out(pass, binding, ty);
        }
        let views = self.scene.views(self.size, self.heights);
        let view = PassViews {
            target: pass.view_target,
            seen: pass.view_seen,
        };
        host_buffers::bytes(resource, &pass.shader, ty, &self.scene, &views, view)
    }
}
