"""Requests and answers of MODBUS as bytes, on TCP and on serial lines."""
