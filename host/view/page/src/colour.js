import {Color, SRGBColorSpace} from 'three';

/** @param rgb  as the server says it, 0..255 each */
export function fromBytes([r, g, b]) {
  return new Color().setRGB(r / 255, g / 255, b / 255, SRGBColorSpace);
}
