"""A certificate for tests, in DER, and its key.

Arguments: the two files, the name, the days since it is valid, and the days until it is not.
"""

import datetime
import ipaddress
import sys

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import rsa

certificate, key_file, name, since, until = sys.argv[1:]
key = rsa.generate_private_key(public_exponent=65537, key_size=2048)
subject = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, name)])
now = datetime.datetime.now(datetime.timezone.utc)
alternatives = [
    x509.UniformResourceIdentifier("urn:g7:peer"),
    x509.DNSName("localhost"),
    x509.IPAddress(ipaddress.ip_address("127.0.0.1")),
]
usage = dict.fromkeys(
    ["crl_sign", "encipher_only", "decipher_only", "key_agreement"], False
) | dict.fromkeys(
    ["digital_signature", "content_commitment", "key_encipherment", "data_encipherment", "key_cert_sign"], True
)
made = (
    x509.CertificateBuilder()
    .subject_name(subject)
    .issuer_name(subject)
    .public_key(key.public_key())
    .serial_number(x509.random_serial_number())
    .not_valid_before(now - datetime.timedelta(days=int(since)))
    .not_valid_after(now + datetime.timedelta(days=int(until)))
    .add_extension(x509.SubjectAlternativeName(alternatives), False)
    .add_extension(x509.BasicConstraints(ca=False, path_length=None), False)
    .add_extension(x509.KeyUsage(**usage), False)
    .add_extension(
        x509.ExtendedKeyUsage([x509.ExtendedKeyUsageOID.SERVER_AUTH, x509.ExtendedKeyUsageOID.CLIENT_AUTH]), False
    )
    .sign(key, hashes.SHA256())
)
with open(certificate, "wb") as file:
    file.write(made.public_bytes(serialization.Encoding.DER))
with open(key_file, "wb") as file:
    file.write(
        key.private_bytes(
            serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
        )
    )
