//! The truth, and what it says of what a pipeline shows.

use meniscus_measure::{Comparison, Picture};
use meniscus_reference::Truth;
use meniscus_scene::{Scene, View};

use crate::ablation::{Ablation, AblationError, RowOutcome};
use crate::subject::{self, Stage, Subject};
use crate::truth;

/// The truth, made ready to judge by.
pub(crate) struct Judging<'a> {
    size: [u32; 2],
    border: u32,
    diagonal: f64,
    truth: &'a Truth,
    scene: &'a Scene,
    view: View,
    points: Vec<meniscus_measure::Seen>,
    projected: Vec<Option<[f64; 2]>>,
}

/// The border band's width as a share of the frame's height.
const BORDER_SHARE: f64 = 1.0 / 24.0;

impl<'a> Judging<'a> {
    pub fn new(ablation: &Ablation, truth: &'a Truth, scene: &'a Scene, view: View) -> Self {
        let points = truth::seen(truth);
        let projected = truth::project(&points, truth, scene, &view);
        let (low, high) = scene.bounds().unwrap_or_default();
        Self {
            size: ablation.size,
            border: (f64::from(ablation.size[1]) * BORDER_SHARE).ceil() as u32,
            // A scene without extent has no diagonal; any positive cap serves.
            diagonal: (high - low).length().max(1.0),
            truth,
            scene,
            view,
            points,
            projected,
        }
    }

    /// Of the frame as it is; at another moment than the stage's, that moment's scene is to be given.
    pub fn judge(
        &self,
        subject: &mut Subject,
        stage: &Stage,
        moment: Option<&Scene>,
    ) -> Result<RowOutcome, AblationError> {
        if let Some(scene) = moment {
            subject.frame.update(scene)?;
        }
        let colours = subject.colours()?;
        let shown = subject.shown(stage, moment)?;
        let points = subject::seen(&shown);
        let projected = truth::project(&points, self.truth, self.scene, &self.view);
        let lists = subject.lists(self.size)?;
        let judgement = Comparison {
            size: self.size,
            border_px: self.border,
            scene_diagonal_m: self.diagonal,
            water: &self.truth.water_first,
            undefined: &self.truth.undefined,
            shown: Picture {
                points: &points,
                projected: &projected,
                colours: &colours,
            },
            truth: Picture {
                points: &self.points,
                projected: &self.projected,
                colours: &self.truth.colour,
            },
        }
        .judge()?;
        Ok(RowOutcome {
            colours,
            shown,
            lists,
            judgement,
        })
    }
}
