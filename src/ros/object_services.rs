//! Services that ask for one object or change it.

use super::{
    node::NotCreated,
    qos,
    services::{Orders, serve},
    topic::Latched,
    transport::Node,
    worker::Command,
};
use crate::{
    config::RosArguments,
    mapping::{Edit, NewObject, ObjectId},
    msg::{
        convert::pose_from_message,
        ellipsoid_slam::{
            AddObject, AddObjectRequest, AddObjectResponse, ApproachObject, DeleteObject,
            EditResponse, LockObject, RenameObject,
        },
    },
    publication::{OutputTopic, approach_object},
};
use nalgebra::Vector3;
use std::{cell::RefCell, future::ready};
use tokio::task::LocalSet;

/// Starts the services.
pub(super) fn serve_objects(
    node: &mut Node,
    arguments: &RosArguments,
    orders: &Orders,
    tasks: &LocalSet,
) -> Result<(), NotCreated> {
    let name = |service: &str| arguments.resolve(&format!("~/{service}"));
    let on = orders.clone();
    let topic = arguments.resolve(OutputTopic::ApproachPose.name());
    let approached = RefCell::new(Latched::new(node.publisher(&topic, &qos::latched())?));
    serve::<ApproachObject, _>(node, &name("approach_object"), tasks, move |request| {
        let known = on.known.borrow().clone();
        let ground = on.parameters.borrow().node.ground;
        let at = (on.status.present(), on.map_frame.as_str());
        let (objects, whereabouts) = (&known.objects, &known.whereabouts);
        let response = approach_object(&request, objects, whereabouts, &ground, at);
        if response.success {
            approached.borrow_mut().send(response.pose.clone());
        }
        ready(response)
    })?;
    let on = orders.clone();
    serve::<RenameObject, _>(node, &name("rename_object"), tasks, move |request| {
        on.clone().edit(Edit::Rename(ObjectId(request.id), request.name))
    })?;
    let on = orders.clone();
    serve::<DeleteObject, _>(node, &name("delete_object"), tasks, move |request| {
        on.clone().edit(Edit::Delete(ObjectId(request.id)))
    })?;
    let on = orders.clone();
    serve::<LockObject, _>(node, &name("lock_object"), tasks, move |request| {
        on.clone().edit(Edit::Lock(ObjectId(request.id), request.locked))
    })?;
    let on = orders.clone();
    serve::<AddObject, _>(node, &name("add_object"), tasks, move |request| on.clone().add(request))
}

impl Orders {
    async fn edit(self, edit: Edit) -> EditResponse {
        match self.edited(edit).await {
            Ok((_, message)) => EditResponse { success: true, message },
            Err(message) => EditResponse { success: false, message },
        }
    }

    async fn add(self, request: AddObjectRequest) -> AddObjectResponse {
        let added = match self.described(request) {
            Ok(new) => self.edited(Edit::Add(new)).await,
            Err(why) => Err(why),
        };
        match added {
            Ok((id, message)) => AddObjectResponse { success: true, message, id: id.0 },
            Err(message) => AddObjectResponse { success: false, message, id: 0 },
        }
    }

    /// The object that a request describes.
    fn described(&self, request: AddObjectRequest) -> Result<NewObject, String> {
        let frame = request.pose.header.frame_id.trim_start_matches('/');
        if !frame.is_empty() && frame != self.map_frame {
            return Err(format!("the pose is in `{frame}`, and has to be in `{}`", self.map_frame));
        }
        let Some(pose) = pose_from_message(&request.pose.pose) else {
            return Err("the pose is not finite, or its orientation has no length".into());
        };
        let size = request.size;
        let label = request.label;
        let outline = self.parameters.borrow().slam.perception.classes.prior(label.trim()).outline;
        let size_m = Vector3::new(size.x, size.y, size.z);
        Ok(NewObject { label, pose, size_m, outline, locked: request.locked })
    }

    /// Has the worker do it; which object it was, and a sentence.
    async fn edited(&self, edit: Edit) -> Result<(ObjectId, String), String> {
        let what = edit.to_string();
        let id = self.ask(|answer| Command::Edit(edit, answer)).get().await??;
        Ok((id, format!("object {id} {what}")))
    }
}
