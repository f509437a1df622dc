// The QR code of a link. The library is loaded when the first code is wanted.

/** The greatest number of bytes in a QR code of the largest size (version 40, correction level L; ISO/IEC 18004, table 7). */
export const MOST_QR = 2953;

/** The code as SVG, with the margin of four modules that the standard asks for. */
export async function qrOf(text: string): Promise<string> {
  const { default: encodeQR } = await import('qr');
  // Without paper of its own the code cannot be read on a dark page.
  return encodeQR(text, 'svg', { ecc: 'low', border: 4 }).replace('>', '><rect width="100%" height="100%" fill="#fff"/>');
}
