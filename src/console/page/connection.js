// The WebSocket to the console: asks for images and states one by one, and comes back by itself.

const kRetry_ms = 1000;
const kBetween_ms = 45;  // at most about 20 images and 20 states a second
const kOn_time_ms = 10;  // a beat that is later than this shows a page with more to do than it can
const kGive_way = 4;     // milliseconds more between images for each that beats are later than that
const kForget = 0.9;     // of how late they were, with each beat
const kLatest_ms = 100;  // later still counts as this: a page that was hidden or asleep comes back at once
const kSilent_ms = 3000;
const kHeader_bytes = 16;

export class Connection {
  hello = null;
  state = null;
  bye = '';
  #socket = null;
  #handlers = new Map();
  #asked_ms = { image: 0, state: 0 };
  #waiting = { image: false, state: false };
  #late_ms = 0;  // the latest of the last beats

  /// Calls `handler` with every message of that kind; also `image`, `opened`, `closed`.
  on(kind, handler) {
    if (!this.#handlers.has(kind)) this.#handlers.set(kind, []);
    this.#handlers.get(kind).push(handler);
  }

  get open() { return this.#socket?.readyState === WebSocket.OPEN; }
  get operating() { return this.open && !!this.state?.you_operate; }
  get mode() { return this.state?.mode ?? 'offline'; }

  /// False where there is no connection.
  send(message) {
    if (!this.open) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  start() {
    this.#connect();
    setInterval(() => this.#drop_if_silent(), 1000);
  }

  #emit(kind, message) {
    for (const handler of this.#handlers.get(kind) ?? []) handler(message);
  }

  #connect() {
    const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = new WebSocket(`${scheme}//${location.host}/ws`);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => this.#opened();
    socket.onmessage = event => {
      if (socket === this.#socket) this.#receive(event.data);
    };
    socket.onclose = () => {
      if (socket === this.#socket) this.#closed();
    };
    this.#socket = socket;
  }

  #opened() {
    this.bye = '';
    this.#emit('opened');
    this.#ask_soon('state');
    this.#ask_soon('image');
  }

  #closed() {
    this.#socket = null;
    this.state = null;
    this.#waiting = { image: false, state: false };
    this.#emit('closed');
    setTimeout(() => this.#connect(), kRetry_ms);
  }

  /// A network that is gone does not close a socket for minutes.
  #drop_if_silent() {
    const since_ms = performance.now() - this.#asked_ms.state;
    if (!this.#waiting.state || document.hidden || since_ms < kSilent_ms) return;
    const socket = this.#socket;
    this.#closed();
    socket.close();
  }

  /// What the page shows comes after its heartbeat: where that was late, fewer images and states are asked for.
  give_way(late_ms) {
    this.#late_ms = Math.max(Math.min(late_ms, kLatest_ms) - kOn_time_ms, kForget * this.#late_ms);
  }

  /// A hidden page gets no animation frames, hence asks for nothing and costs nothing.
  #ask_soon(what) {
    const socket = this.#socket;
    const between_ms = kBetween_ms + kGive_way * this.#late_ms;
    const wait_ms = Math.max(0, this.#asked_ms[what] + between_ms - performance.now());
    setTimeout(() => requestAnimationFrame(() => {
      if (socket !== this.#socket || !this.send({ do: 'more', of: what })) return;
      this.#asked_ms[what] = performance.now();
      this.#waiting[what] = true;
    }), wait_ms);
  }

  #receive(data) {
    if (data instanceof ArrayBuffer) return this.#receive_image(data);
    const message = JSON.parse(data);
    if (message.kind === 'hello') this.hello = message;
    if (message.kind === 'bye') this.bye = message.text;
    if (message.kind === 'state') this.#receive_state(message);
    this.#emit(message.kind, message);
  }

  #receive_state(state) {
    this.state = state;
    this.#waiting.state = false;
    this.#ask_soon('state');
  }

  /// The next image is asked for once this one is decoded, so a slow page is sent fewer.
  async #receive_image(data) {
    const socket = this.#socket;
    const times = new DataView(data);
    const jpeg = new Blob([data.slice(kHeader_bytes)], { type: 'image/jpeg' });
    try {
      const bitmap = await createImageBitmap(jpeg);
      if (this.hello) this.hello.image = { width_px: bitmap.width, height_px: bitmap.height };  // the greeting came before the camera
      if (socket === this.#socket) this.#emit('image', { bitmap, taken_s: times.getFloat64(0, true), sent_s: times.getFloat64(8, true) });
    } catch {
      // A broken image is skipped; its successor is asked for all the same.
    }
    this.#waiting.image = false;
    if (socket === this.#socket) this.#ask_soon('image');
  }
}
