//! Objects that began with a wrong measurement begin anew.

use super::{MapObject, views::View};
use crate::{
    geometry::Ellipsoid,
    graph::{Graph, PoseId},
};
use nalgebra::Point3;

impl MapObject {
    /// Begins where this measurement in the map is, without what was measured or glimpsed before. Returns the poses that
    /// the object was seen from.
    pub(super) fn begin_anew(&mut self, graph: &mut Graph, measured: &Ellipsoid) -> Vec<PoseId> {
        self.looks.clear();
        self.company.acquit();
        graph.set_ellipsoid(self.variable, *measured);
        self.forget_views(graph)
    }

    /// Forgets all views, and with them that there were only glimpses. Returns the poses they were made from.
    pub(super) fn forget_views(&mut self, graph: &mut Graph) -> Vec<PoseId> {
        self.glimpsed = false;
        let views: Vec<View> = self.views.all().cloned().collect();
        self.views.take(graph, &views);
        self.remove_ties(graph, |_| true);
        views.iter().map(|view| view.keyframe.pose).collect()
    }

    /// An object that began with an outlier stays at it: the robust kernel then takes what is right for outliers. So where
    /// more measurements are near the latest one than near the estimate, the estimate begins anew there.
    pub(super) fn begin_anew_if_wrong(&mut self, graph: &mut Graph, measured: &Ellipsoid) {
        let center = measured.center();
        let estimate = graph.ellipsoid(self.variable).center();
        let reach = measured.semi_axes.norm();
        let near = |place: &Point3<f64>| self.looks.near(place, reach);
        if nalgebra::distance(&center, &estimate) > reach && near(&center) > near(&estimate) {
            graph.set_ellipsoid(self.variable, *measured);
        }
    }
}
