//! The nodes of the server of our own, and what clients do with them.
//!
//! The library browses, reads and subscribes. Here is what differs: who has written which input, and which
//! sessions there are.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use g7_online::{About, Folder, Raw, Remark, Scaling, Shown, Wire, Wired};
use opcua::core::sync::RwLock;
use opcua::server::CreateMonitoredItem;
use opcua::server::address_space::{
    AccessLevel, AddressSpace, NodeType, ObjectBuilder, VariableBuilder, read_node_value,
};
use opcua::server::authenticator::UserToken;
use opcua::server::diagnostics::NamespaceMetadata;
use opcua::server::node_manager::memory::InMemoryNodeManagerImpl;
use opcua::server::node_manager::{ParsedReadValueId, RequestContext, ServerContext, WriteNode};
use opcua::types::{
    AttributeId, DataTypeId, DataValue, DateTime, EUInformation, ExtensionObject, LocalizedText, NodeId,
    QualifiedName, StatusCode, TimestampsToReturn, UAString, VariableTypeId, Variant,
};

use crate::guard;
use crate::values;

/// The URI of the namespace that holds the nodes of a chart.
pub(crate) const NAMESPACE: &str = "urn:g7:chart";

/// The number of sessions at which those that have ended are forgotten.
const SESSIONS: usize = 200;

/// Writes that wait to be told; the driver takes them many times a second.
const DEEDS: usize = 1000;

/// True while a session of a client is there.
type Lives = Arc<dyn Fn() -> bool + Send + Sync>;

/// An input that clients write.
pub(crate) struct Input {
    pub(crate) name: String,
    scaling: Scaling,
    written: Option<Written>,
}

/// A value that a client has written.
struct Written {
    value: Raw,
    who: Option<String>,
    session: Lives,
}

/// The things that the library and the driver share.
#[derive(Default)]
pub(crate) struct Desk {
    pub(crate) inputs: Vec<Input>,
    /// By number: each client that has asked for a node.
    sessions: BTreeMap<u32, Client>,
    /// Values that were written and not told yet.
    deeds: Vec<Remark>,
}

/// A session of a client.
struct Client {
    user: UserToken,
    lives: Lives,
}

impl Desk {
    /// The number of clients that are there.
    pub(crate) fn clients(&mut self) -> usize {
        self.sessions.retain(|_, client| (client.lives)());
        self.sessions.len()
    }

    /// True if one of them is not let in any more.
    pub(crate) fn has_stranger(&mut self, knows: impl Fn(&UserToken) -> bool) -> bool {
        self.clients();
        self.sessions.values().any(|client| !knows(&client.user))
    }

    /// The values that were written since the last call.
    pub(crate) fn deeds(&mut self) -> Vec<Remark> {
        std::mem::take(&mut self.deeds)
    }

    /// Nobody is there any more.
    pub(crate) fn clear(&mut self) {
        self.sessions.clear();
        self.inputs.iter_mut().for_each(|input| input.written = None);
    }

    /// The value of an input; `None` where no client has written it who is still there.
    pub(crate) fn value(&mut self, input: usize) -> Option<Raw> {
        let input = self.inputs.get_mut(input)?;
        if input.written.as_ref().is_some_and(|written| !(written.session)()) {
            input.written = None;
        }
        input.written.as_ref().map(|written| written.value)
    }

    /// Takes a value for an input. One that is another one, or from somebody else, is told.
    fn put(&mut self, at: usize, written: Written) -> Result<(), StatusCode> {
        let was = self.value(at);
        let Some(input) = self.inputs.get_mut(at) else { return Err(StatusCode::BadNotWritable) };
        let by = input.written.as_ref().and_then(|written| written.who.as_ref());
        if was != Some(written.value) || by != written.who.as_ref() {
            if self.deeds.len() >= DEEDS {
                return Err(StatusCode::BadTooManyOperations);
            }
            let (value, who) = (written.value, written.who.clone());
            self.deeds.push(Remark::Written { input: at, value, who });
        }
        input.written = Some(written);
        Ok(())
    }
}

/// The desk, as both sides have it.
#[derive(Clone, Default)]
pub(crate) struct Shared(Arc<Mutex<Desk>>);

impl Shared {
    pub(crate) fn of(wired: &Wired) -> Shared {
        let of = |input: &g7_online::In| Input {
            name: shown(&input.wire).map(|shown| shown.name.clone()).unwrap_or_default(),
            scaling: input.scaling,
            written: None,
        };
        let inputs = wired.inputs.iter().map(of).collect();
        Shared(Arc::new(Mutex::new(Desk { inputs, ..Desk::default() })))
    }

    pub(crate) fn lock(&self) -> MutexGuard<'_, Desk> {
        // Each field is set whole, so it is whole after a panic too.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes that a client has asked.
    fn note(&self, context: &RequestContext) -> Lives {
        let session = Arc::downgrade(&context.session);
        let lives: Lives = Arc::new(move || {
            session.upgrade().is_some_and(|session| {
                let session = session.read();
                // The time behind an instant that is to come is none.
                session.is_activated() && session.deadline().elapsed().is_zero()
            })
        });
        let mut desk = self.lock();
        if desk.sessions.len() >= SESSIONS {
            desk.clients();
        }
        let client = Client { user: context.token.clone(), lives: Arc::clone(&lives) };
        desk.sessions.insert(context.session_id, client);
        lives
    }
}

/// The node of a wire, where it is one of ours.
pub(crate) fn shown(wire: &Wire) -> Option<&Shown> {
    match wire {
        Wire::Shown(shown) => Some(shown),
        _ => None,
    }
}

/// The nodes of a chart.
pub(crate) struct Nodes {
    namespace: NamespaceMetadata,
    shared: Shared,
}

/// A node that is to be made.
pub(crate) struct Plan {
    shown: Shown,
    scaling: Scaling,
    writable: bool,
}

/// The nodes of a server.
pub(crate) fn plan(wired: &Wired) -> Vec<Plan> {
    let inputs = wired.inputs.iter().map(|i| (&i.wire, i.scaling, true));
    let outputs = wired.outputs.iter().map(|o| (&o.wire, o.out.scaling, false));
    let of = |(wire, scaling, writable)| shown(wire).map(|s| Plan { shown: s.clone(), scaling, writable });
    inputs.chain(outputs).filter_map(of).collect()
}

impl Nodes {
    /// Makes the nodes.
    pub(crate) fn build(
        plan: &[Plan],
        shared: Shared,
        context: &ServerContext,
        space: &mut AddressSpace,
    ) -> Nodes {
        let index = context.type_tree.write().namespaces_mut().add_namespace(NAMESPACE);
        space.add_namespace(NAMESPACE, index);
        let top = NodeId::new(index, "Chart");
        folder(space, &top, "Chart", &NodeId::objects_folder_id());
        let folders: BTreeSet<Folder> = plan.iter().map(|node| node.shown.folder).collect();
        for part in folders {
            folder(space, &folder_id(index, part), word(part), &top);
        }
        plan.iter().for_each(|node| variable(space, index, node));
        let namespace = NamespaceMetadata {
            namespace_uri: NAMESPACE.to_owned(),
            namespace_index: index,
            ..NamespaceMetadata::default()
        };
        Nodes { namespace, shared }
    }

    /// The index of the namespace.
    pub(crate) fn index(&self) -> u16 {
        self.namespace.namespace_index
    }

    /// Takes what a client writes to an input.
    fn write(
        &self,
        user: &UserToken,
        lives: &Lives,
        node: &NodeType,
        value: &DataValue,
    ) -> Result<(), StatusCode> {
        let NodeType::Variable(variable) = node else { return Err(StatusCode::BadNotWritable) };
        let name = name_of(node);
        let mut desk = self.shared.lock();
        let Some((at, input)) = desk.inputs.iter().enumerate().find(|(_, input)| input.name == name) else {
            return Err(StatusCode::BadNotWritable);
        };
        if value.status.is_some_and(|status| !status.is_good()) {
            return Err(StatusCode::BadWriteNotSupported);
        }
        let given = value.value.as_ref().ok_or(StatusCode::BadTypeMismatch)?;
        // The library lets other types pass.
        let (_, own) = values::own(&input.scaling);
        if given.scalar_type_id() != Some(own) || given.is_array() || variable.value_rank() != -1 {
            return Err(StatusCode::BadTypeMismatch);
        }
        let raw = values::raw(given, input.scaling.kind).map_err(|_| StatusCode::BadTypeMismatch)?;
        input.scaling.word(raw).ok_or(StatusCode::BadOutOfRange)?;
        let who = guard::name_of(user).map(str::to_owned);
        desk.put(at, Written { value: raw, who, session: Arc::clone(lives) })
    }
}

/// The name of a node: its identifier.
fn name_of(node: &NodeType) -> String {
    match &node.as_node().node_id().identifier {
        opcua::types::Identifier::String(name) => name.to_string(),
        _ => String::new(),
    }
}

/// Words of the folders; a variable may have such a name, so a folder has another identifier.
fn word(folder: Folder) -> &'static str {
    match folder {
        Folder::Inputs => "Inputs",
        Folder::Outputs => "Outputs",
        Folder::Variables => "Variables",
        Folder::Steps => "Steps",
    }
}

fn folder_id(index: u16, folder: Folder) -> NodeId {
    NodeId::new(index, folder as u32 + 1)
}

fn folder(space: &mut AddressSpace, id: &NodeId, name: &str, parent: &NodeId) {
    ObjectBuilder::new(id, QualifiedName::new(id.namespace, name), name)
        .is_folder()
        .organized_by(parent.clone())
        .insert(space);
}

fn variable(space: &mut AddressSpace, index: u16, plan: &Plan) {
    let Plan { shown: Shown { name, folder, about }, scaling, writable } = plan;
    let id = NodeId::new(index, name.as_str());
    let level = if *writable {
        AccessLevel::CURRENT_READ | AccessLevel::CURRENT_WRITE
    } else {
        AccessLevel::CURRENT_READ
    };
    let (data_type, _) = values::own(scaling);
    let About { comment, unit } = about;
    let kind =
        if unit.is_some() { VariableTypeId::AnalogUnitType } else { VariableTypeId::BaseDataVariableType };
    VariableBuilder::new(&id, QualifiedName::new(index, name.as_str()), name.as_str())
        .description(LocalizedText::new("", comment.as_deref().unwrap_or("")))
        .data_type(data_type)
        .value_rank(-1)
        .access_level(level)
        .user_access_level(level)
        .has_type_definition(kind)
        .organized_by(folder_id(index, *folder))
        .insert(space);
    if let Some(NodeType::Variable(variable)) = space.find_mut(&id) {
        variable.set_data_value(nothing());
    }
    if let Some(unit) = unit {
        let information = EUInformation {
            namespace_uri: UAString::null(),
            // The unit has no number of the list of units (OPC 10000-8, 5.6.3).
            unit_id: -1,
            display_name: LocalizedText::new("", unit),
            description: LocalizedText::new("", unit),
        };
        let property = NodeId::new(index, format!("{name}/EngineeringUnits"));
        VariableBuilder::new(&property, QualifiedName::new(0, "EngineeringUnits"), "EngineeringUnits")
            .data_type(DataTypeId::EUInformation)
            .value(Variant::from(ExtensionObject::from_message(information)))
            .value_rank(-1)
            .has_type_definition(VariableTypeId::PropertyType)
            .property_of(id)
            .insert(space);
    }
}

/// The value of a node that has none yet.
pub(crate) fn nothing() -> DataValue {
    DataValue::new_now_status(Variant::Empty, StatusCode::BadWaitingForInitialData)
}

#[async_trait::async_trait]
impl InMemoryNodeManagerImpl for Nodes {
    async fn init(&self, _: &mut AddressSpace, _: ServerContext) {}

    fn name(&self) -> &'static str {
        "chart"
    }

    fn namespaces(&self) -> Vec<NamespaceMetadata> {
        vec![self.namespace.clone()]
    }

    async fn read_values(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        nodes: &[&ParsedReadValueId],
        max_age: f64,
        stamps: TimestampsToReturn,
    ) -> Vec<DataValue> {
        self.shared.note(context);
        let (space, now) = (space.read(), DateTime::now());
        let read = |node: &&ParsedReadValueId| match space.validate_node_read(context, node) {
            Ok(found) => {
                let mut value = read_node_value(found, context, node, max_age, stamps);
                // The value is that of now, however long it has been the same.
                if value.server_timestamp.is_some() {
                    value.server_timestamp = Some(now);
                }
                value
            }
            Err(status) => DataValue { status: Some(status), ..DataValue::default() },
        };
        nodes.iter().map(read).collect()
    }

    async fn create_value_monitored_items(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        items: &mut [&mut &mut CreateMonitoredItem],
    ) {
        let nodes: Vec<ParsedReadValueId> = items.iter().map(|item| item.item_to_monitor().clone()).collect();
        let nodes: Vec<&ParsedReadValueId> = nodes.iter().collect();
        let values = self.read_values(context, space, &nodes, 0.0, TimestampsToReturn::Both).await;
        for (value, item) in values.into_iter().zip(items.iter_mut()) {
            if value.status() != StatusCode::BadAttributeIdInvalid {
                item.set_initial_value(value);
            }
            item.set_status(StatusCode::Good);
        }
    }

    async fn write(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        writes: &mut [&mut WriteNode],
    ) -> Result<(), StatusCode> {
        let lives = self.shared.note(context);
        let mut space = space.write();
        let types = context.type_tree.read();
        let mut changed = Vec::new();
        for write in writes {
            let node = match space.validate_node_write(context, write.value(), &*types) {
                Ok(node) => node,
                Err(status) => {
                    write.set_status(status);
                    continue;
                }
            };
            let asked = write.value();
            if asked.attribute_id != AttributeId::Value || asked.index_range.has_range() {
                write.set_status(StatusCode::BadNotWritable);
                continue;
            }
            match self.write(&context.token, &lives, node, &asked.value) {
                Ok(()) => {
                    let value = DataValue::new_now(asked.value.value.clone().unwrap_or_default());
                    if let NodeType::Variable(variable) = node {
                        variable.set_data_value(value.clone());
                    }
                    changed.push((value, asked.node_id.clone()));
                    write.set_status(StatusCode::Good);
                }
                Err(status) => write.set_status(status),
            }
        }
        drop((space, types));
        let changed = changed.iter().map(|(value, id)| (value.clone(), id, AttributeId::Value));
        context.subscriptions.notify_data_change(changed);
        Ok(())
    }
}
