//! Other nodes of our own name on DDS: ROS 2 allows them, and then services answer twice.

use crate::ros::node::NotCreated;
use ros2_client::{
    Gid,
    builtin_topics::ros_discovery,
    dds::{
        Context, Node, Subscription,
        rustdds::{TopicKind, discovery::DiscoveredWriterData},
    },
    entities_info::ParticipantEntitiesInfo,
};
use std::collections::BTreeSet;

/// Listens to what participants say about their nodes.
pub(super) struct SameName {
    infos: Subscription<ParticipantEntitiesInfo>,
    own: Gid,
    others: BTreeSet<Gid>,
}

impl SameName {
    pub(super) fn listen(context: &Context, node: &mut Node) -> Result<Self, NotCreated> {
        let participant = context.domain_participant();
        let topic = participant
            .create_topic(
                ros_discovery::TOPIC_NAME.into(),
                ros_discovery::TYPE_NAME.into(),
                &ros_discovery::QOS_PUB,
                TopicKind::NoKey,
            )
            .map_err(|e| NotCreated::new(ros_discovery::TOPIC_NAME, e))?;
        let infos = node
            .create_subscription(&topic, None)
            .map_err(|e| NotCreated::new(ros_discovery::TOPIC_NAME, e))?;
        let own = context.participant_entities_info().gid();
        Ok(Self { infos, own, others: BTreeSet::new() })
    }

    /// Whether another participant has a node of this full name at present.
    pub(super) fn has_another(
        &mut self,
        full_name: &str,
        writers: &[DiscoveredWriterData],
    ) -> bool {
        while let Ok(Some((info, _))) = self.infos.take() {
            let named_alike =
                info.nodes().iter().any(|node| node.fully_qualified_name() == full_name);
            if info.gid() == self.own {
                continue;
            }
            if named_alike {
                self.others.insert(info.gid());
            } else {
                self.others.remove(&info.gid());
            }
        }
        // One that was killed says nothing any more, but discovery has forgotten its publishers.
        let lives = |other: &Gid| {
            let participant = |gid: Gid| gid.to_bytes16().into_iter().take(GUID_PREFIX);
            writers
                .iter()
                .any(|w| participant(w.publication_topic_data.key.into()).eq(participant(*other)))
        };
        self.others.retain(lives);
        !self.others.is_empty()
    }
}

/// Bytes of a GUID that name the participant.
const GUID_PREFIX: usize = 12;
