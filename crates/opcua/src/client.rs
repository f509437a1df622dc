//! Servers of OPC UA, which G7 is a client of.
//!
//! Inputs come by subscription: the server sends what has changed. Outputs are written when they change.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use g7_host::Kind;
use g7_model::Nanos;
use g7_online::setup::{NodeId, OpcUa};
use g7_online::{Absent, Device, Failed, Raw, Wire, Wired};
use opcua::client::{DataChangeCallback, Session};
use opcua::types::{
    AttributeId, DataTypeId, DataValue, Error, ExtensionObject, MonitoredItemCreateRequest, MonitoringMode,
    MonitoringParameters, ReadValueId, StatusCode, TimestampsToReturn, Variant, VariantScalarTypeId as Type,
    WriteValue,
};

use crate::session::{Connection, plain};
use crate::time::duration;
use crate::values;

/// Nodes in one request.
const AT_ONCE: usize = 500;
/// Signs of life that may be missing, one after the other.
const MISSING: i64 = 3;

/// A node of the server with its variable.
#[derive(Clone, Debug)]
struct Point {
    node: NodeId,
    kind: Kind,
}

/// The values that the server has sent.
type Values = Arc<Mutex<Vec<Result<Raw, Absent>>>>;

/// The node and the type of an output, or why it cannot be written.
type Writable = Result<(opcua::types::NodeId, Type), String>;

/// A server as a device.
pub(crate) struct Client {
    server: OpcUa,
    timeout: Duration,
    inputs: Vec<Point>,
    outputs: Vec<Point>,
    values: Values,
    live: Option<Live>,
}

/// A connection, and what is known of the nodes of the outputs.
struct Live {
    connection: Connection,
    outputs: Vec<Writable>,
    /// The longest silence of the subscription; none where there is nothing to hear.
    silence: Option<Nanos>,
}

impl Client {
    pub(crate) fn new(server: &OpcUa, wired: &Wired) -> Client {
        let point = |wire: &Wire, kind| match wire {
            Wire::Node(node) => Some(Point { node: node.clone(), kind }),
            _ => None,
        };
        Client {
            server: server.clone(),
            timeout: duration(wired.device.timing.timeout),
            inputs: wired.inputs.iter().filter_map(|i| point(&i.wire, i.scaling.kind)).collect(),
            outputs: wired.outputs.iter().filter_map(|o| point(&o.wire, o.out.scaling.kind)).collect(),
            values: Values::default(),
            live: None,
        }
    }

    /// Subscribes to the inputs. Returns the longest silence.
    fn subscribe(&self, connection: &Connection) -> Result<Option<Nanos>, Failed> {
        let mut values = vec![Err(Absent::Unread); self.inputs.len()];
        let mut nodes = Vec::new();
        for (k, point) in self.inputs.iter().enumerate() {
            match connection.node(&point.node) {
                Ok(node) => nodes.push((k, node)),
                Err(why) => set(&mut values, k, Err(Absent::Refused(why))),
            }
        }
        *self.values.lock().unwrap_or_else(PoisonError::into_inner) = values;
        if nodes.is_empty() {
            return Ok(None);
        }
        let (interval, session) = (duration(self.server.interval), Arc::clone(&connection.session));
        let count = self.server.keep_alive.count_of(self.server.interval).max(1);
        let count = u32::try_from(count).unwrap_or(u32::MAX / 100);
        let taker = self.taker();
        let sampling = interval.as_secs_f64() * 1e3;
        let made = connection.wait(self.timeout, async move {
            let id = session.create_subscription(interval, count * 10, count, 0, 0, true, taker).await?;
            let revised = {
                let state = session.subscription_state.lock();
                state.get(id).map(|s| s.publishing_interval().saturating_mul(s.max_keep_alive_count()))
            };
            let mut refused = Vec::new();
            for part in nodes.chunks(AT_ONCE) {
                let items = part.iter().map(|(k, node)| item(*k, node, sampling)).collect();
                let made = session.create_monitored_items(id, TimestampsToReturn::Both, items).await?;
                let results = made
                    .iter()
                    .map(|m| m.result.status_code)
                    .chain(std::iter::repeat(StatusCode::BadUnexpectedError));
                refused
                    .extend(part.iter().zip(results).filter(|(_, s)| s.is_bad()).map(|((k, _), s)| (*k, s)));
            }
            Ok((revised, refused))
        });
        let (revised, refused) = made?;
        let mut values = self.values.lock().unwrap_or_else(PoisonError::into_inner);
        for (k, status) in refused {
            set(&mut values, k, Err(Absent::Refused(node_is(status))));
        }
        let each = revised.map_or(self.server.keep_alive, |time| {
            Nanos::new(i64::try_from(time.as_nanos()).unwrap_or(i64::MAX / MISSING))
        });
        Ok(Some(each.max(self.server.interval) * MISSING))
    }

    /// Takes the values that the server sends.
    fn taker(&self) -> DataChangeCallback {
        let values = Arc::clone(&self.values);
        let kinds: Vec<Kind> = self.inputs.iter().map(|point| point.kind).collect();
        let uncertain_is_good = self.server.uncertain_is_good;
        DataChangeCallback::new(move |value, item| {
            let Some(k) = usize::try_from(item.client_handle()).ok().and_then(|handle| handle.checked_sub(1))
            else {
                return;
            };
            let Some(kind) = kinds.get(k) else { return };
            let value = judge(&value, *kind, uncertain_is_good);
            set(&mut values.lock().unwrap_or_else(PoisonError::into_inner), k, value);
        })
    }

    /// Asks for the types of the nodes of the outputs.
    fn types(&self, connection: &Connection) -> Result<Vec<Writable>, Failed> {
        let nodes: Vec<Result<opcua::types::NodeId, String>> =
            self.outputs.iter().map(|point| connection.node(&point.node)).collect();
        let mut asked = Vec::new();
        for node in nodes.iter().flatten() {
            for attribute in [AttributeId::Value, AttributeId::DataType] {
                asked.push(ReadValueId { attribute_id: attribute as u32, ..ReadValueId::from(node.clone()) });
            }
        }
        let session = Arc::clone(&connection.session);
        let answers = connection.wait(self.timeout, async move {
            let mut answers = Vec::new();
            for part in asked.chunks(AT_ONCE) {
                answers.extend(session.read(part, TimestampsToReturn::Neither, 0.0).await?);
            }
            Ok(answers)
        })?;
        let mut answers = answers.chunks_exact(2);
        let of = |node: Result<opcua::types::NodeId, String>| {
            let node = node?;
            match answers.next() {
                Some([value, data_type]) => type_of(value, data_type).map(|of| (node, of)),
                _ => Err("the server does not tell its type".to_owned()),
            }
        };
        Ok(nodes.into_iter().map(of).collect())
    }

    fn write(
        &self,
        live: &Live,
        outputs: &[Raw],
        write: &[bool],
        refused: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let (mut at, mut writes) = (Vec::new(), Vec::new());
        let points = self.outputs.iter().zip(&live.outputs);
        for (k, ((point, known), raw)) in
            points.zip(outputs).enumerate().filter(|(k, _)| write.get(*k) == Some(&true))
        {
            let value =
                known.clone().and_then(|(node, of)| Ok((node, values::variant(*raw, of, point.kind)?)));
            match value {
                Ok((node, value)) => {
                    at.push(k);
                    writes.push(WriteValue {
                        node_id: node,
                        attribute_id: AttributeId::Value as u32,
                        index_range: opcua::types::NumericRange::None,
                        value: DataValue::value_only(value),
                    });
                }
                Err(why) => set(refused, k, Some(why)),
            }
        }
        if writes.is_empty() {
            return Ok(());
        }
        let session = Arc::clone(&live.connection.session);
        let answers = live.connection.wait_alive(self.timeout, live.silence, send(session, writes))?;
        let answers = answers.into_iter().chain(std::iter::repeat(StatusCode::BadUnexpectedError));
        for (k, status) in at.into_iter().zip(answers).filter(|(_, status)| status.is_bad()) {
            set(refused, k, Some(node_is(status)));
        }
        Ok(())
    }
}

async fn send(session: Arc<Session>, writes: Vec<WriteValue>) -> Result<Vec<StatusCode>, Error> {
    let mut answers = Vec::new();
    for part in writes.chunks(AT_ONCE) {
        answers.extend(session.write(part).await?);
    }
    Ok(answers)
}

fn item(k: usize, node: &opcua::types::NodeId, sampling: f64) -> MonitoredItemCreateRequest {
    let parameters = MonitoringParameters {
        client_handle: u32::try_from(k + 1).unwrap_or(u32::MAX),
        sampling_interval: sampling,
        filter: ExtensionObject::null(),
        // Only the latest value counts.
        queue_size: 1,
        discard_oldest: true,
    };
    MonitoredItemCreateRequest::new(node.clone().into(), MonitoringMode::Reporting, parameters)
}

/// The value of an input, as far as it is one.
fn judge(value: &DataValue, kind: Kind, uncertain_is_good: bool) -> Result<Raw, Absent> {
    let status = value.status();
    if !(status.is_good() || status.is_uncertain() && uncertain_is_good) {
        return Err(Absent::Refused(node_is(status)));
    }
    values::raw(value.value.as_ref().unwrap_or(&Variant::Empty), kind).map_err(Absent::Refused)
}

/// The answer of the server about a node, in words.
fn node_is(status: StatusCode) -> String {
    match status {
        StatusCode::BadNodeIdUnknown => "the server has no such node (BadNodeIdUnknown)".to_owned(),
        StatusCode::BadNotWritable => "the node cannot be written (BadNotWritable)".to_owned(),
        StatusCode::BadTypeMismatch => "the node has another type (BadTypeMismatch)".to_owned(),
        StatusCode::BadUserAccessDenied => "the user may not do that (BadUserAccessDenied)".to_owned(),
        StatusCode::BadOutOfRange => "the node cannot have this value (BadOutOfRange)".to_owned(),
        other => plain(other),
    }
}

/// The type of a node: that of its value, or else the one that it declares.
fn type_of(value: &DataValue, data_type: &DataValue) -> Result<Type, String> {
    match &value.value {
        Some(Variant::Empty) | None => {}
        Some(variant @ Variant::Array(_)) => {
            return Err(format!("the node holds {}", values::type_of(variant)));
        }
        Some(variant) => {
            return variant.scalar_type_id().ok_or_else(|| "the node has no type".to_owned());
        }
    }
    let Some(Variant::NodeId(id)) = &data_type.value else {
        return Err(node_is(data_type.status()));
    };
    match id.as_data_type_id() {
        Ok(DataTypeId::Boolean) => Ok(Type::Boolean),
        Ok(DataTypeId::SByte) => Ok(Type::SByte),
        Ok(DataTypeId::Byte) => Ok(Type::Byte),
        Ok(DataTypeId::Int16) => Ok(Type::Int16),
        Ok(DataTypeId::UInt16) => Ok(Type::UInt16),
        Ok(DataTypeId::Int32) => Ok(Type::Int32),
        Ok(DataTypeId::UInt32) => Ok(Type::UInt32),
        Ok(DataTypeId::Int64) => Ok(Type::Int64),
        Ok(DataTypeId::UInt64) => Ok(Type::UInt64),
        Ok(DataTypeId::Float) => Ok(Type::Float),
        Ok(DataTypeId::Double | DataTypeId::Duration) => Ok(Type::Double),
        _ => Err(format!("the node has the type {id}, which is no number and no Boolean")),
    }
}

impl Device for Client {
    fn connect(&mut self) -> Result<(), Failed> {
        let connection = Connection::open(&self.server, self.timeout)?;
        let outputs = self.types(&connection)?;
        let silence = self.subscribe(&connection)?;
        self.live = Some(Live { connection, outputs, silence });
        Ok(())
    }

    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        refused: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let Some(live) = &self.live else { return Err(Failed("there is no connection".to_owned())) };
        live.connection.life.alive(live.silence)?;
        self.write(live, outputs, write, refused)?;
        let values = self.values.lock().unwrap_or_else(PoisonError::into_inner);
        for (input, value) in inputs.iter_mut().zip(values.iter()) {
            *input = value.clone();
        }
        Ok(())
    }

    fn close(&mut self) {
        if let Some(live) = self.live.take() {
            live.connection.close(self.timeout);
        }
    }
}

fn set<T>(list: &mut [T], at: usize, value: T) {
    if let Some(slot) = list.get_mut(at) {
        *slot = value;
    }
}
