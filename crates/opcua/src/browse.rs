//! The nodes of a server, as a list.

use std::collections::HashSet;
use std::sync::Arc;
use std::time::Duration;

use g7_online::setup::OpcUa;
use g7_online::{Failed, Node};
use opcua::client::Session;
use opcua::types::{
    BrowseDescription, BrowseDirection, BrowseResult, Error, NodeClass, NodeClassMask, NodeId, ObjectId,
    ReferenceDescription, ReferenceTypeId,
};

use crate::session::Connection;

/// Nodes that are listed, and levels that are walked down.
const MOST: usize = 2000;
const DEEPEST: usize = 10;
/// All fields of a reference (OPC 10000-4, 5.9.2).
const ALL: u32 = 0x3f;
/// Times the time-out for the whole walk.
const PATIENCE: u32 = 10;

/// The nodes below `Objects`, without the server's own.
///
/// # Errors
///
/// The server cannot be reached, or does not answer.
pub(crate) fn browse(server: &OpcUa, timeout: Duration) -> Result<Vec<Node>, Failed> {
    let connection = Connection::open(server, timeout)?;
    let session = Arc::clone(&connection.session);
    let nodes = connection.wait(timeout * PATIENCE, walk(session));
    connection.close(timeout);
    nodes
}

async fn walk(session: Arc<Session>) -> Result<Vec<Node>, Error> {
    let own: NodeId = ObjectId::Server.into();
    let mut seen: HashSet<NodeId> = HashSet::from([own]);
    let mut found: Vec<Node> = Vec::new();
    let mut pending: Vec<(ReferenceDescription, usize)> = Vec::new();
    let mut next = Some((NodeId::objects_folder_id(), 0));
    while let Some((id, depth)) = next {
        if depth <= DEEPEST && found.len() < MOST {
            // The first one is next.
            for child in children(&session, &id).await?.into_iter().rev() {
                if seen.insert(child.node_id.node_id.clone()) {
                    pending.push((child, depth));
                }
            }
        }
        next = pending.pop().map(|(child, depth)| {
            found.push(Node {
                point: format!("node({})", child.node_id.node_id),
                name: child.browse_name.name.to_string(),
                depth,
                value: child.node_class == NodeClass::Variable,
            });
            (child.node_id.node_id, depth + 1)
        });
    }
    Ok(found)
}

/// The objects and variables right below a node.
async fn children(session: &Session, id: &NodeId) -> Result<Vec<ReferenceDescription>, Error> {
    let asked = BrowseDescription {
        node_id: id.clone(),
        browse_direction: BrowseDirection::Forward,
        reference_type_id: ReferenceTypeId::HierarchicalReferences.into(),
        include_subtypes: true,
        node_class_mask: (NodeClassMask::OBJECT | NodeClassMask::VARIABLE).bits(),
        result_mask: ALL,
    };
    let mut results = session.browse(&[asked], 0, None).await?;
    let mut all = Vec::new();
    while let Some(BrowseResult { references, continuation_point, .. }) = results.pop() {
        all.extend(references.unwrap_or_default());
        if continuation_point.is_null_or_empty() || all.len() >= MOST {
            break;
        }
        results = session.browse_next(false, &[continuation_point]).await?;
    }
    all.retain(|child| child.node_id.server_index == 0);
    Ok(all)
}
