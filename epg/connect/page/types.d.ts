// SPDX-License-Identifier: Apache-2.0
// The types of the page's data, for the TypeScript compiler, which checks the page's JavaScript in the tests. The browser
// does not read this file. The tests also compare State with the states that real sessions send.

/** The state of a session with an open target: epg/connect/session.py makes it from the files and the draft. */
interface State extends StartState {
  project: Project & { targets: string[] };
  components: Component[];
  /** The topics of ports that the system connects, without a component of the target. */
  by_system: Record<string, string>;
  /** The ends of each port of the model that the bindings name. An output that is unconnected on purpose has none. */
  wires: Record<string, End[]>;
  /** For ports without a wire: the component port with a similar name. */
  proposals: Record<string, string>;
  /** For each port of the model: all component ports of the right direction. */
  candidates: Record<string, string[]>;
  /** For each port of the model: the candidates that agree with it in type and unit. */
  fits: Record<string, string[]>;
  hardware: HardwareRow[];
  /** For each unit: its dimension, and its factor to the dimension's own unit. */
  units: Record<string, [string, number]>;
  /** The pictures of the target: false for a picture that errors prevent. A target without pins has no "wiring". */
  pictures: Record<string, boolean>;
  forms: Forms;
  pins: {
    /** The signals of components that need a pin. */
    signals: PinSignal[];
    /** The errors of pins and peripherals, each with a signal whose pin can be changed. */
    problems: { component: string; signal: string; message: string }[];
    /** The reason why pins cannot be changed; empty if they can. */
    why_not: string;
  };
  /** The uses of each component that has any. */
  users: Record<string, Users>;
  /** The errors that saving would make in other targets, while the user decides about them. */
  ask: { target: string; errors: Message[] }[];
  /** The parts of the robot that no port uses. */
  unused: string[];
  draft: Draft;
  editable: boolean;
  /** The reason why ports cannot be connected; empty if they can. */
  why_not: string;
}

/** The state while a system is shown, and none of its targets is open. */
interface SystemState extends StartState {
  project: Project & { targets: string[] };
  system: System | null;
  pictures: Record<string, boolean>;
  draft: Draft;
}

interface System {
  name: string;
  targets: { name: string; target: string; middleware: string; period: string; model: string }[];
  connections: Connection[];
  /** The ends to which other programs send. */
  world: (SystemEnd & { topic: string })[];
  loops: string[];
  /** The common plant, and the number of its wires to each target. */
  plant: { name: string; step: string; wires: Record<string, number> } | null;
}

/** A connection. The texts after its topic are empty as long as errors prevent them. */
interface Connection {
  from: SystemEnd;
  to: SystemEnd;
  topic: string;
  message: string;
  unit: string;
  sent: string;
  age: string;
}

interface SystemEnd {
  target: string;
  component: string;
  /** The component, one of its values, or a port of the model. */
  port: string;
}

/** The state before a target is chosen for a model. The page shows one of the three phases. */
interface StartState {
  version: number;
  /** The version of EPG. */
  epg: string;
  phase: "connect" | "choose" | "system";
  project: (Project & { targets: string[] }) | null;
  /** The proposed folder and name of a new project; null in the phase "connect". */
  create: { folder: string; name: string } | null;
  model: Model | null;
  diagnostics: Message[];
  /** In the phase "system" only; null if the file cannot be read. */
  system?: System | null;
  /** Empty until the server has read them. */
  configurations: Configuration[];
  build: Build;
  simulation: SimulationRun;
  program: ProgramRun;
  flash: FlashRun;
  comparison: ComparisonRun;
  live: Live;
  /** Null while EPG looks for them. */
  simulations: Simulations | null;
}

/** The connection with a running target. */
interface Live {
  /** The page begins with this tab. */
  opens: boolean;
  /** False: the target has no console, so the page cannot connect with it. */
  console: boolean;
  /** The port of a target that needs a key, which the user must type; empty: there is none. */
  locked: string;
  ports: { path: string; device: string }[];
  target: LiveTarget | null;
  problem: Refusal | null;
  /** A target whose connection was lost, with the last words about its state. */
  lost: { name: string; state: Record<string, string> } | null;
}

interface LiveTarget {
  path: string;
  name: string;
  version: string;
  hash: string;
  /** False: the target has another firmware than that of the last build, and can only be watched. */
  matches: boolean;
  period: number;
  /** Control cycles per row; 0: the target has no memory for streams. */
  every: number;
  /** The words of the target about its state, such as enabled: "1". */
  state: Record<string, string>;
  /** The latched fault in a sentence, and the next steps of the user. */
  fault: { text: string; remedy: string } | null;
  /** `loop`: a duration of the control loop, which is streamed but cannot be recorded around a trigger. */
  signals: { name: string; unit: string; loop: boolean }[];
  /** The recording of every cycle; `number` counts those that can be read. */
  capture: { state: "none" | "recording" | "ready"; rows: number; wanted: number; number: number };
  setpoints: LiveSetpoint[];
  actuators: string[];
  parameters: LiveParameter[];
}

/** A setpoint with its limits in `unit`, the signal that it follows, and its value after an enabling. */
interface LiveSetpoint {
  name: string;
  unit: string;
  low: number | null;
  high: number | null;
  follows: string;
  /** A value that was sent before the enabling does not act. */
  fresh: boolean;
  starts: number | null;
}

interface LiveParameter {
  name: string;
  value: number;
  generated: number;
  unit: string;
  low: number | null;
  high: number | null;
}

interface Project {
  name: string;
  folder: string;
  /** Of a target: tcf, model, bindings; of a system: system. */
  files: Record<string, string>;
  /** The system that the target is part of, and was opened from. */
  system: string | null;
}

interface Draft {
  changed: boolean;
  can_undo: boolean;
  can_redo: boolean;
  diff: string;
  /** Set while an edit by another program and the draft do not fit together. */
  conflict: Refusal | null;
  /** A note about an edit by another program. */
  external: string | null;
}

interface Model {
  name: string;
  origin: string;
  /** In seconds; 0 if the model has no fixed step. */
  step: number;
  inputs: Port[];
  outputs: Port[];
}

/** A port of the model. */
interface Port {
  name: string;
  unit: string;
  type: string;
  description: string;
}

interface Component {
  name: string;
  kind: string;
  summary: string;
  /** Its pins, as "a GP10". */
  where: string[];
  peripheral: string;
  topic: string;
  ports: ComponentPort[];
}

interface ComponentPort {
  name: string;
  direction: "source" | "sink";
  /** The port's name in the bindings: "encoder_pan.reset", or the component's name for its main port. */
  reference: string;
  unit: string;
  type: string;
  summary: string;
}

/** One end of a wire, with its conversion as the bindings write it. */
interface End {
  reference: string;
  scale: string;
  offset: string;
  limits: [string, string] | null;
  unit: string;
  /** The model input that a setpoint follows; empty if there is none. */
  follows: string;
  /** The conversion in one line; empty if there is none. */
  text: string;
  /** The conversion that the component does before. */
  from_tcf: string;
  component_unit: string;
  model_unit: string;
}

/** A message of EPG or of the build. Messages of compilers have no notes; some have no place. */
/** The rows of the stream that can be saved: recorded since a time in s since 1970, sizes in bytes. */
interface KeptRows {
  since: number;
  size: number;
  most: number;
  problem: string;
  /** The part of a file that has been written; null: none is being written. */
  saving: number | null;
}

interface Message extends Place {
  id: string;
  severity: "error" | "warning" | "note";
  message: string;
  hint: string;
  notes?: (Place & { message: string })[];
  /** The port of the model that the message is about. */
  port: string | null;
  /** That port, and others that the message names. */
  ports?: string[];
  component?: string | null;
  /** The keys of the value in a .tcf that the message is about. */
  path?: string[];
  /** In a system: the targets whose files have the mistake. */
  targets?: string[];
  /** The changes that the hint proposes and that the page can make. Of several, the user chooses one. */
  edits?: Edit[];
}

/** `new` in place of `old`, the text from `line` and `column` to `end_line` and `end`. An insertion has an empty `old`. */
interface Edit extends Place {
  end_line: number;
  end: number;
  old: string;
  new: string;
  sentence: string;
}

interface Place {
  file: string;
  line: number;
  column: number;
}

/** The forms of the target: epg/connect/forms.py makes them. */
interface Forms {
  kinds: Record<string, KindForm>;
  settings: { title: string; fields: Field[] }[];
  /** The values in the files, by their keys: "components.pwm_pan.frequency". */
  values: Record<string, Value>;
  /** The inherited components that the project's own .tcf removes. */
  left_out: string[];
  /** The reason why the values cannot be changed here; empty if they can. */
  locked: string;
  /** The other targets that read the project's own .tcf. */
  shared: string[];
}

/** The uses of a component: ports, components, settings by their keys, and files that EPG does not change here. */
interface Users {
  ports: string[];
  components: string[];
  settings: string[];
  files: string[];
}

interface KindForm {
  group: string;
  summary: string;
  /** Their paths are those below a component. */
  fields: Field[];
  /** Sets of fields of which a component must set one, or several. */
  one_of: { names: string[]; several: boolean }[];
  /** The reason why the target cannot have such a component; empty if it can. */
  unusable: string;
}

interface Field {
  path: string[];
  name: string;
  type:
    | "quantity"
    | "ratio"
    | "number"
    | "integer"
    | "boolean"
    | "text"
    | "choice"
    | "reference"
    | "pin"
    | "yaml"
    | "group";
  description: string;
  required?: boolean;
  default?: string;
  units?: string[];
  choices?: string[];
  limits?: string;
  example?: string;
  /** The title of the part of the form in which the field is, if it is not the first one. */
  section?: string;
  /** The fields of a group. */
  fields?: Field[];
}

/** A value as it is written, and its place. */
interface Value extends Origin {
  text: string;
  /** True if the project's own file has it. */
  own?: boolean;
  /** True if the project's own file removes an inherited value. */
  removed?: boolean;
  /** The value without the project's own file, if another file has one. */
  back?: Origin & { text: string };
}

interface Origin {
  /** The project's own file, another one of the user, one of EPG, or an argument in CMake. */
  how: "own" | "file" | "epg" | "call";
  file: string;
  line: number;
}

/** A signal of a component, and its pin; empty if the board does not have it. */
interface PinSignal {
  component: string;
  signal: string;
  pin: string;
}

/** A pin of the board for a signal. */
interface PinOption {
  pin: string;
  /** The names that are printed on the board, if they differ. */
  printed: string;
  /** Its number on the board; empty if it is not known. */
  contact: string;
  state: "current" | "fits" | "used" | "reserved" | "unfit";
  reason: string;
  /** The pins that this choice changes. */
  changes: PinSignal[];
}

interface HardwareRow {
  component: string;
  claim: string;
  resource: string;
  pins: string;
  frequency: string;
  remark: string;
}

/** A target that can be chosen: a predefined .tcf file, or a board with a platform. */
interface Configuration {
  name: string;
  summary: string;
  robot: string;
  board: string;
  platform: string;
  target: string;
  chosen: boolean;
  possible: boolean;
  reason: string;
  missing: string[];
  components: number;
  /** The number of the model's ports that match a component by name. */
  matches: number;
  ports: number;
  picture: boolean;
}

/** What a build, a simulation and other runs have in common. */
interface Activity {
  state: "idle" | "running" | "done" | "failed" | "cancelled";
  step: string;
  action: string;
  done: number;
  total: number;
  seconds: number;
  messages: Message[];
  /** The number of lines of the log. */
  lines: number;
  /** True if nothing was started because tools are missing that the project's CMake files may still find. */
  can_try: boolean;
  /** The question before the first run of these commands. */
  ask: Ask | null;
}

interface Ask {
  folder: string;
  /** Empty if the user has agreed to them before. */
  commands: string[];
  programs: string[];
  key: string;
  /** Proposed wires that must be connected first: for each port of the model the port of a component. */
  wires: Record<string, string>;
}

interface Build extends Activity {
  products: Product[];
}

interface Product {
  path: string;
  what: string;
  /** True for a program for this computer. */
  runs: boolean;
}

interface FlashRun extends Activity {
  /** What was written to where; empty before the first time. */
  file: string;
  board: string;
  /** True if the board has the program of another target. */
  can_replace: boolean;
  /** The boards that were found and wait for a confirmation. Without one, "problem" is the reason. */
  boards: { found: { id: string; shown: string; file: string }[]; problem: string; hint: string } | null;
}

interface ProgramRun extends Activity {
  /** The path of the program; empty before the first run. */
  program: string;
  /** The terminal of its console; empty if it has none. */
  port: string;
}

interface SimulationRun extends Activity {
  /** Null until the program has run to its end. */
  result: SimulationResult | null;
}

interface ComparisonRun extends Activity {
  /** `changed` are the parameters that were changed in the target only. */
  result: { number: number; changed: string[] } | null;
}

/** Values that are not finite are null. */
interface SimulationResult {
  passed: boolean;
  /** The reason why the run ended in a wrong state; empty if it did not. */
  problem: string;
  hint: string;
  checks: { text: string; value: number | null; limit: number; unit: string; passed: boolean }[];
  windows: {
    axis: string;
    unit: string;
    start: number;
    end: number;
    rms: number | null;
    largest: number | null;
  }[];
  cycles: number;
  duration: number;
  folder: string;
  files: string[];
  /** Differs between two pictures. */
  picture: string;
}

/** The simulations of the target. Without one, "problem" is the reason. */
interface Simulations {
  found: { name: string; scenario: string }[];
  problem: string;
  hint: string;
}

type Nothing = Record<string, never>;

/** The actions of a session, with the bodies of their requests. */
interface Actions {
  connect: { port: string; ends: Partial<End>[] };
  /** Several ports in one step; ends of null remove a port. */
  rewire: { changes: { port: string; ends: Partial<End>[] | null }[] };
  disconnect: { port: string };
  /** Without ports, all proposals are accepted. */
  accept: { ports?: string[] };
  /** Makes the edit of a message. */
  apply: { file: string; line: number; column: number; new: string };
  leave_out: Nothing;
  unset: { paths: string[][] };
  choose_pin: { component: string; signal: string; pin: string };
  /** Without signals, all signals without a pin. */
  first_pins: { signals?: { component: string; signal: string }[] };
  /** An empty text means that no file sets the value. */
  fill: { changes: { path: string[]; text: string }[] };
  take_back: { path: string[] };
  /** `values` are the texts of fields, by their keys joined by dots. */
  add: { kind: string; name: string; values: Record<string, string> };
  copy: { component: string; name: string };
  rename: { component: string; name: string };
  remove: { component: string };
  undo: Nothing;
  redo: Nothing;
  /** `agreed`: although other targets of the project then have errors. */
  save: { anyway?: boolean; agreed?: boolean };
  reload: Nothing;
  choose: { configuration: string };
  open: { target: string };
  overview: Nothing;
  create: { folder: string; name: string; configuration: string; middleware?: string };
  /** `run` is the key of the question that the user has agreed to; `anyway` builds although tools are missing. */
  generate: { run?: string; anyway?: boolean };
  /** "accept" agrees to the proposed wires of the question. */
  simulate: { run?: string; anyway?: boolean; accept?: boolean; simulation?: string };
  /** Compares the running target with its simulation. */
  compare: { run?: string; anyway?: boolean; simulation?: string };
  /** Runs a product of the last build in real time. */
  run: { path: string; run?: string };
  /** Without "board", looks for boards; with it, writes the last product to this board. */
  flash: { board?: string; replace?: boolean };
  cancel: Nothing;
  done: Nothing;
}

/** The changes that a move to another target would make. */
interface Move {
  items: {
    what: "changed" | "dropped" | "asked" | "kept";
    key: string;
    before: string;
    after: string;
    reason: string;
  }[];
  /** Other files of the project; null if EPG has no project for the platform. */
  files: { name: string; what: "written" | "removed" | "asked"; new: boolean; lines: string }[] | null;
}

/** The server's answer to a refused action. */
interface Refusal {
  message: string;
  hint: string;
}

/** The user of a component port: an end of the model's port `port`. */
interface User {
  port: string;
  end: End;
}

/** The end of a wire that the user holds: a port of the model, or the reference of a component port. */
interface Held {
  side: string;
  name: string;
  by: "pointer" | "keyboard";
}

// What the compiler's own types of the browser lack. Each element of the page is one of HTML or of SVG.
interface Element extends HTMLOrSVGElement {}
interface Document {
  prerendering?: boolean;
}
