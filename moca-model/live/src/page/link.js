// The socket to the loop.

class Link {
  /** `heard` is called with each message. */
  constructor(heard, lost) {
    Object.assign(this, { heard, lost, sent: 0, steers: false });
    this.open();
  }

  open() {
    this.socket = new WebSocket(`ws://${location.host}/live`);
    this.socket.addEventListener("open", () => (this.sent = 0));
    this.socket.addEventListener("message", (event) => this.heard(JSON.parse(event.data)));
    this.socket.addEventListener("close", () => {
      this.lost();
      setTimeout(() => this.open(), 1000);
    });
  }

  /** Asks for something; gives the number of the message, or 0 if nobody hears it. */
  ask(what, more = {}) {
    if (this.socket.readyState !== WebSocket.OPEN) return 0;
    this.socket.send(JSON.stringify({ do: what, ...more }));
    this.sent += 1;
    return this.sent;
  }
}
