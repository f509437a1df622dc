// Points of devices as texts, and which of them fit a signal. The kinds come from the server; nothing
// here knows one of them by name.
import type { Argument, Channel, Kind, PointKind, Setting, Settings, Sight, Signal, Table } from './told';

export interface Named {
  device: string;
  word: string;
  argument: string;
}

/** Cuts `line1.coil(2)`, or `plc.DB1.DBX0.0`, which has no word and no brackets. */
export function parsed(text: string | null): Named | null {
  const found = /^\s*(.*\S)\s*\.\s*(\w+)\s*\((.*)\)\s*$/.exec(text ?? '');
  if (found) return { device: found[1] ?? '', word: found[2] ?? '', argument: (found[3] ?? '').trim() };
  const alone = /^\s*([^.()]*[^.()\s])\s*\.\s*([^()]*[^()\s])\s*$/.exec(text ?? '');
  return alone ? { device: alone[1] ?? '', word: '', argument: alone[2] ?? '' } : null;
}

export const written = ({ device, word, argument }: Named): string => (word === '' ? `${device}.${argument}` : `${device}.${word}(${argument})`);

/** The points of a kind that can carry a signal in a table of the io file. */
export function fitting(kind: Kind | undefined, signal: Signal, table: Table): PointKind[] {
  const carries = (p: PointKind) =>
    signal.carries !== 'text' &&
    (p.carries === 'any' || p.carries === signal.carries || (p.carries === 'number' && signal.carries === 'whole'));
  const used = (p: PointKind) => (table === 'inputs' ? p.input : p.output);
  if (table === 'shown' && !kind?.shows) return [];
  return kind?.points.filter((p) => used(p) && carries(p)) ?? [];
}

/** The point of a kind that a text names: words may be there twice, for a register and for one bit of it. */
export function pointOf(kind: Kind | undefined, named: Named | null, signal: Signal): PointKind | undefined {
  const bit = /^\d+\.\d+$/.test(named?.argument ?? '');
  const same = kind?.points.filter((p) => p.word === named?.word) ?? [];
  return same.find((p) => (p.argument.is === 'bit') === bit) ?? same.find((p) => p.carries === signal.carries) ?? same.find((p) => p.carries === 'number' && signal.carries === 'whole') ?? same[0];
}

export const settingsOf = (point: PointKind | undefined, table: Table): Setting[] => (table === 'inputs' ? point?.of_input : point?.of_output) ?? [];

/** The registers that a form of number takes. */
function registers(signal: Signal, settings: Settings): number {
  const form = typeof settings.as === 'string' ? settings.as : '';
  const bits = Number(/\d+$/.exec(form)?.[0] ?? 0);
  if (bits > 0) return Math.max(1, bits / 16);
  if (/^(L|UL)(INT|WORD|REAL)$/i.test(signal.type)) return 4;
  return /^(D|UD)|REAL|TIME/i.test(signal.type) ? 2 : 1;
}

/** The address in the address of the chart: `%I0.3` is the bit 3, `%IW4` the register 4. */
export function charted(signal: Signal): number | null {
  const found = /^%?[IQM]([XBWDL]?)(\d+)(?:\.(\d+))?$/i.exec(signal.address ?? '');
  if (!found) return null;
  const [, size, first, second] = found;
  return second !== undefined && !/[WDL]/i.test(size ?? '') ? Number(first) * 8 + Number(second) : Number(first);
}

/** The arguments that are offered for a point: the address of the chart, and the next that is free. */
export function offered(sight: Sight, signal: Signal, device: string, point: PointKind): string[] {
  const taken = new Set<string>();
  const channels: Channel[] = [...sight.channels.inputs, ...sight.channels.outputs, ...sight.channels.shown];
  for (const channel of channels) {
    const named = parsed(channel.at);
    if (!named || named.device !== device || named.word !== point.word || channel.variable === signal.name) continue;
    const other = sight.signals.find((s) => s.name === channel.variable);
    const [first, bit] = named.argument.split('.');
    const from = Number(first);
    if (bit !== undefined) taken.add(`${from}.${bit}`);
    const wide = bit === undefined && other && other.carries !== 'bit' ? registers(other, channel.settings) : 1;
    for (let k = 0; k < wide; k++) taken.add(String(from + k));
  }
  const argument: Argument = point.argument;
  if (argument.is === 'address') {
    const wide = signal.carries === 'bit' ? 1 : registers(signal, {});
    const free = (from: number) => Array.from({ length: wide }, (_, k) => !taken.has(String(from + k))).every(Boolean);
    const next = Array.from({ length: 4096 }, (_, k) => k).find(free);
    const own = charted(signal);
    const found = [own !== null && free(own) && own <= argument.most ? own : null, next ?? null];
    return [...new Set(found.filter((n) => n !== null).map(String))];
  }
  if (argument.is === 'bit') {
    for (let k = 0; k < 4096 * 16; k++) {
      const at = `${Math.floor(k / 16)}.${k % 16}`;
      if (!taken.has(at) && !taken.has(String(Math.floor(k / 16)))) return [at];
    }
  }
  if (argument.is === 'list' || argument.is === 'text' || argument.is === 'alone') return [argument.example];
  if (argument.is === 'word') return [argument.words[0] ?? ''];
  return argument.is === 'name' ? [''] : [];
}

/** The straight line through two points: from numbers of the device to values of the chart. */
export function line(raw: [number, number], value: [number, number]): { scale: number; offset: number } | null {
  const [r0, r1, v0, v1] = [...raw, ...value];
  if (r1 === r0 || v1 === v0 || ![r0, r1, v0, v1].every(Number.isFinite)) return null;
  const scale = Number(((v1 - v0) / (r1 - r0)).toPrecision(12));
  return { scale, offset: Number((v0 - scale * r0).toPrecision(12)) };
}
