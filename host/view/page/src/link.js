// server -> [LINK] -> messages, one at a time: the next one is asked for when the last one was drawn.
import {decode} from './message.js';

const kFirstPause_ms = 300, kLongestPause_ms = 5000;

export class Link {
  /**
   * @param take    called with every decoded message
   * @param state   called with 'open' or 'lost'
   */
  constructor(take, state) {
    this.take = take;
    this.state = state;
    this.pause_ms = kFirstPause_ms;
    this.#connect();
  }

  say(word) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(word);
  }

  #connect() {
    const token = new URLSearchParams(location.hash.slice(1)).get('token');
    const query = token ? `?token=${encodeURIComponent(token)}` : '';
    const socket = new WebSocket(`${location.origin.replace('http', 'ws')}/scene${query}`);
    this.socket = socket;
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.pause_ms = kFirstPause_ms;
      this.state('open');
      this.say('next');
    };
    socket.onmessage = ({data}) => {
      this.take(decode(data));
      requestAnimationFrame(() => this.say('next'));
    };
    socket.onclose = () => {
      this.state('lost');
      setTimeout(() => this.#connect(), this.pause_ms);
      this.pause_ms = Math.min(2 * this.pause_ms, kLongestPause_ms);
    };
  }
}
